#include "core/io/sample_clouds.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/io/numbers.h"
#include "core/io/sample_rows.h"

namespace ccst::io {
namespace {

// Where the bytes red, green and blue of the first colours are among the fields; 0 without them.
std::size_t FirstColor(const SampleRows& rows) {
  for (std::size_t i = kFurtherFields; i + 2 < rows.fields.size(); ++i) {
    if (rows.fields[i].type == NumberType::kUint8 && rows.fields[i].name == "red") return i;
  }
  return 0;
}

// The blocks behind the XML, each with its length in front, and where they begin.
class Appended {
 public:
  std::string Array(const std::string& type, const std::string& name, int components,
                    const std::string& values) {
    const std::string element =
        absl::StrCat("<DataArray type=\"", type, "\" Name=\"", name, "\" NumberOfComponents=\"",
                     components, "\" format=\"appended\" offset=\"", bytes_.size(), "\"/>\n");
    AppendLittleEndian(bytes_, static_cast<std::uint64_t>(values.size()));
    bytes_ += values;
    return element;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Cells of `corners` corners each, the corners being `indices`.
std::string Cells(Appended& appended, const std::vector<std::int64_t>& indices, int corners) {
  std::string connectivity;
  std::string offsets;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    AppendLittleEndian(connectivity, indices[i]);
    const auto behind = static_cast<std::int64_t>(i + 1);
    if (behind % corners == 0) AppendLittleEndian(offsets, behind);
  }
  return appended.Array("Int64", "connectivity", 1, connectivity) +
         appended.Array("Int64", "offsets", 1, offsets);
}

}  // namespace

std::string EncodePcd(const SampleSet& samples) {
  const SampleRows rows = ToRows(samples);
  const std::size_t color = FirstColor(rows);
  std::string names = "FIELDS x y z normal_x normal_y normal_z";
  std::string sizes = "SIZE 4 4 4 4 4 4";
  std::string types = "TYPE F F F F F F";
  std::string counts = "COUNT 1 1 1 1 1 1";
  const auto add = [&](const std::string& name, std::size_t size, char type) {
    absl::StrAppend(&names, " ", name);
    absl::StrAppend(&sizes, " ", size);
    (types += ' ') += type;
    counts += " 1";
  };
  if (color > 0) add("rgb", 4, 'F');
  for (std::size_t i = kFaceField; i < rows.fields.size(); ++i) {
    if (color > 0 && i >= color && i < color + 3) continue;
    add(rows.fields[i].name, NamesOf(rows.fields[i].type).bytes, NamesOf(rows.fields[i].type).pcd);
  }
  const std::size_t count = rows.count();
  std::string out =
      absl::StrCat("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n", names, "\n", sizes,
                   "\n", types, "\n", counts, "\nWIDTH ", count,
                   "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS ", count, "\nDATA binary\n");
  const std::size_t normals = rows.OffsetOf(kNormalField);
  const std::size_t further = rows.OffsetOf(kFaceField);
  const std::size_t color_begin = color > 0 ? rows.OffsetOf(color) : rows.row_bytes;
  const std::size_t color_end = color > 0 ? color_begin + 3 : rows.row_bytes;
  out.reserve(out.size() + count * rows.row_bytes);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i * rows.row_bytes;
    for (const double value : samples.positions[i]) {
      AppendLittleEndian(out, static_cast<float>(value));
    }
    out.append(rows.bytes, row + normals, further - normals);
    if (color > 0) {
      // 0x00RRGGBB, least significant byte first.
      for (const std::size_t at : {2, 1, 0}) out += rows.bytes[row + color_begin + at];
      out += '\0';
    }
    out.append(rows.bytes, row + further, color_begin - further);
    out.append(rows.bytes, row + color_end, rows.row_bytes - color_end);
  }
  return out;
}

std::string EncodeVtp(const SampleSet& samples) {
  const SampleRows rows = ToRows(samples);
  Appended appended;
  std::string data;
  const auto add = [&](const std::string& name, std::size_t first, std::size_t width) {
    data += appended.Array(NamesOf(rows.fields[first].type).vtk, name, static_cast<int>(width),
                           rows.Slice(first, width));
  };
  add("normals", kNormalField, 3);
  add("face", kFaceField, 1);
  add("barycentrics", kBarycentricField, 2);
  std::size_t next = kFurtherFields;
  if (!samples.face_corners.empty()) {
    add("face_corners", next, 3);
    next += 3;
  }
  for (; next < rows.fields.size(); ++next) add(rows.fields[next].name, next, 1);

  std::vector<std::int64_t> indices;
  const bool has_triangles = !samples.triangles.empty();
  for (const Eigen::Vector3i& triangle : samples.triangles) {
    indices.insert(indices.end(), triangle.begin(), triangle.end());
  }
  for (std::size_t i = 0; !has_triangles && i < rows.count(); ++i) {
    indices.push_back(static_cast<std::int64_t>(i));
  }
  const std::string points = appended.Array("Float64", "points", 3, rows.Slice(kPositionField, 3));
  const std::string cells = Cells(appended, indices, has_triangles ? 3 : 1);
  const char* const kind = has_triangles ? "Polys" : "Verts";
  return absl::StrCat(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"",
      rows.count(), "\" NumberOfVerts=\"", has_triangles ? 0 : rows.count(),
      "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"", samples.triangles.size(),
      "\">\n<PointData Normals=\"normals\">\n", data, "</PointData>\n<Points>\n", points,
      "</Points>\n<", kind, ">\n", cells, "</", kind,
      ">\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_", appended.bytes(),
      "\n</AppendedData>\n</VTKFile>\n");
}

}  // namespace ccst::io
