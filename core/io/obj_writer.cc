#include "core/io/obj_writer.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/io/numbers.h"

namespace ccst::io {
namespace {

const Attribute* FirstByVertex(const std::vector<Attribute>& attributes, AttributeKind kind) {
  const auto found = std::find_if(attributes.begin(), attributes.end(), [kind](const Attribute& a) {
    return a.kind == kind && !a.per_corner;
  });
  return found == attributes.end() ? nullptr : &*found;
}

// The first `count` numbers of a row, each with a space in front.
void AppendRow(std::string& out, const Attribute& attribute, std::size_t row, std::size_t count) {
  const std::size_t start = row * static_cast<std::size_t>(attribute.components);
  for (std::size_t k = 0; k < count; ++k) {
    out += ' ';
    AppendFloat(out, attribute.values[start + k]);
  }
}

}  // namespace

std::string EncodeObj(const std::vector<Eigen::Vector3d>& positions,
                      const std::vector<Eigen::Vector3i>& faces,
                      const std::vector<Attribute>& attributes) {
  const Attribute* const color = FirstByVertex(attributes, AttributeKind::kColor);
  const Attribute* const texture = FirstByVertex(attributes, AttributeKind::kTextureCoordinates);
  std::string out;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    out += 'v';
    for (const double coordinate : positions[i]) {
      out += ' ';
      AppendDouble(out, coordinate);
    }
    if (color != nullptr) AppendRow(out, *color, i, 3);
    out += '\n';
  }
  for (std::size_t i = 0; texture != nullptr && i < positions.size(); ++i) {
    out += "vt";
    AppendRow(out, *texture, i, 2);
    out += '\n';
  }
  for (const Eigen::Vector3i& face : faces) {
    out += 'f';
    for (const int corner : face) {
      out += ' ';
      AppendInteger(out, std::int64_t{corner} + 1);
      if (texture == nullptr) continue;
      out += '/';
      AppendInteger(out, std::int64_t{corner} + 1);
    }
    out += '\n';
  }
  return out;
}

}  // namespace ccst::io
