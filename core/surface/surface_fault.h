#pragma once

#include <string>

#include "core/surface/surface.h"

namespace ccst {

/// What is wrong with a surface, for assertions and tests: positions or normals that are no
/// numbers, faces of vertices that do not exist, twins that do not match, vertices that do not
/// leave through the boundary where there is one, areas and components that do not add up. Empty
/// when nothing is; Surface::Build() makes no other. Cost O(F).
std::string FindFault(const Surface& surface);

}  // namespace ccst
