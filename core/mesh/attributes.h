#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst {

/// Most attributes of a mesh.
inline constexpr std::size_t kMaxAttributes = 64;
/// Longest name of an attribute [byte].
inline constexpr std::size_t kMaxAttributeName = 64;

/// Gives every attribute a name that is fit for every file and for the wire, and that no other
/// has: what is not printable ASCII becomes `_`, long names are cut, no name becomes "color", "uv"
/// or "scalar" by kind, and of equal ones the later get `_2`, `_3`... Names that are like that
/// already stay. Cost O(attributes squared).
void NameAttributes(std::vector<Attribute>& attributes);

/// The attribute of that name; null when there is none.
const Attribute* FindAttribute(const std::vector<Attribute>& attributes, std::string_view name);

/// Rows of `attribute` in `mesh`: V or 3 F.
std::size_t AttributeRows(const TriangleMesh& mesh, const Attribute& attribute);

/// Checks that every attribute of `mesh` has 1 to 4 components and as many values as it needs.
/// Values may be anything, also not finite.
/// @errors INVALID_ARGUMENT  MESH_DEGENERATE, naming the attribute; LIMIT_EXCEEDED more than
///                           kMaxAttributes
absl::Status CheckAttributes(const TriangleMesh& mesh);

}  // namespace ccst
