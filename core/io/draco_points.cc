#include "core/io/draco_points.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#include "core/mesh/attributes.h"

namespace ccst::io {
namespace {

// Sign of the difference between two rows, by their bits: NaN is equal to itself.
int CompareRows(const Attribute& attribute, std::int64_t a, std::int64_t b) {
  const auto width = static_cast<std::size_t>(attribute.components);
  return std::memcmp(attribute.values.data() + static_cast<std::size_t>(a) * width,
                     attribute.values.data() + static_cast<std::size_t>(b) * width,
                     width * sizeof(float));
}

std::int32_t VertexOf(const TriangleMesh& mesh, std::int64_t corner) {
  return mesh.faces[static_cast<std::size_t>(corner / 3)][static_cast<int>(corner % 3)];
}

// Values by vertex instead of by corner, when all corners of every vertex agree. Vertices of no
// face get zeros.
void JoinCorners(const TriangleMesh& mesh, Attribute& attribute) {
  if (!attribute.per_corner) return;
  std::vector<std::int64_t> first(mesh.positions.size(), -1);
  const auto corners = static_cast<std::int64_t>(3 * mesh.faces.size());
  for (std::int64_t c = 0; c < corners; ++c) {
    std::int64_t& seen = first[static_cast<std::size_t>(VertexOf(mesh, c))];
    if (seen < 0) seen = c;
    if (CompareRows(attribute, seen, c) != 0) return;
  }
  const auto width = static_cast<std::size_t>(attribute.components);
  std::vector<float> values(width * mesh.positions.size(), 0.0f);
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (first[v] < 0) continue;
    std::copy_n(attribute.values.begin() + first[v] * attribute.components, width,
                values.begin() + static_cast<std::ptrdiff_t>(width * v));
  }
  attribute.values = std::move(values);
  attribute.per_corner = false;
}

void DropUnusedVertices(TriangleMesh& mesh) {
  constexpr int kUnused = -1;
  constexpr int kUsed = 0;
  std::vector<int> place(mesh.positions.size(), kUnused);
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (const int corner : face) place[static_cast<std::size_t>(corner)] = kUsed;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == kUnused) continue;
    mesh.positions[kept] = mesh.positions[i];
    for (Attribute& attribute : mesh.attributes) {
      if (attribute.per_corner) continue;
      const auto width = static_cast<std::size_t>(attribute.components);
      std::copy_n(attribute.values.begin() + static_cast<std::ptrdiff_t>(width * i), width,
                  attribute.values.begin() + static_cast<std::ptrdiff_t>(width * kept));
    }
    place[i] = static_cast<int>(kept++);
  }
  mesh.positions.resize(kept);
  for (Attribute& attribute : mesh.attributes) {
    if (!attribute.per_corner) {
      attribute.values.resize(kept * static_cast<std::size_t>(attribute.components));
    }
  }
  for (Eigen::Vector3i& face : mesh.faces) {
    for (int& corner : face) corner = place[static_cast<std::size_t>(corner)];
  }
}

}  // namespace

DracoPoints SplitIntoPoints(const TriangleMesh& mesh) {
  std::vector<const Attribute*> by_corner;
  for (const Attribute& attribute : mesh.attributes) {
    if (attribute.per_corner) by_corner.push_back(&attribute);
  }
  const auto compare = [&by_corner](std::int64_t a, std::int64_t b) {
    for (const Attribute* const attribute : by_corner) {
      const int order = CompareRows(*attribute, a, b);
      if (order != 0) return order;
    }
    return 0;
  };
  const auto vertex_count = static_cast<std::int32_t>(mesh.positions.size());
  const std::size_t corner_count = 3 * mesh.faces.size();

  // The corners of each vertex, one vertex after the other.
  std::vector<std::int64_t> start(mesh.positions.size() + 1, 0);
  for (std::size_t c = 0; c < corner_count; ++c) {
    ++start[static_cast<std::size_t>(VertexOf(mesh, static_cast<std::int64_t>(c))) + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::int64_t> corners(corner_count);
  std::vector<std::int64_t> next(start.begin(), start.end() - 1);
  for (std::size_t c = 0; c < corner_count; ++c) {
    const auto v = static_cast<std::size_t>(VertexOf(mesh, static_cast<std::int64_t>(c)));
    corners[static_cast<std::size_t>(next[v]++)] = static_cast<std::int64_t>(c);
  }

  DracoPoints points;
  points.of_corner.resize(corner_count);
  points.vertex.reserve(mesh.positions.size());
  points.corner.reserve(mesh.positions.size());
  const auto add = [&points](std::int32_t vertex, std::int64_t corner) {
    points.vertex.push_back(vertex);
    points.corner.push_back(corner);
  };
  for (std::int32_t v = 0; v < vertex_count; ++v) {
    const auto begin = corners.begin() + start[static_cast<std::size_t>(v)];
    const auto end = corners.begin() + start[static_cast<std::size_t>(v) + 1];
    if (begin == end) add(v, -1);
    if (!by_corner.empty()) {
      std::sort(begin, end, [&compare](std::int64_t a, std::int64_t b) {
        const int order = compare(a, b);
        return order != 0 ? order < 0 : a < b;
      });
    }
    for (auto corner = begin; corner != end; ++corner) {
      if (corner == begin || compare(*(corner - 1), *corner) != 0) add(v, *corner);
      points.of_corner[static_cast<std::size_t>(*corner)] =
          static_cast<std::uint32_t>(points.count() - 1);
    }
  }
  return points;
}

TriangleMesh ToStreamLayout(TriangleMesh mesh) {
  NameAttributes(mesh.attributes);
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
    mesh.attributes[i].id = static_cast<std::int32_t>(i) + 1;  // 0 are the positions.
    JoinCorners(mesh, mesh.attributes[i]);
  }
  const bool has_corners = std::any_of(mesh.attributes.begin(), mesh.attributes.end(),
                                       [](const Attribute& a) { return a.per_corner; });
  const std::size_t points = has_corners ? SplitIntoPoints(mesh).count() : mesh.positions.size();
  if (points > 3 * mesh.faces.size()) DropUnusedVertices(mesh);
  return mesh;
}

}  // namespace ccst::io
