#pragma once

#include "core/base/interrupt.h"
#include "core/repair/repair.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// Splits the faces of `repaired` at sharp edges (turning by 40 to 100 degrees) until none of
/// their sides is longer than `longest` [unit of `surface`], and others as far as a mesh without
/// T-junctions needs. The shape stays as it is. Normals and curvatures are interpolated over faces:
/// beside a crease they are wrong as far as the faces reach, so a large flat face with a sharp rim
/// would seem round. Faces are halved at their longest side, so that angles stay bounded.
/// Source: Rivara, "New longest-edge algorithms for the refinement and/or improvement of
/// unstructured triangulations", IJNME 40, 1997.
/// @param surface   made of `repaired->mesh`.
/// @param most_new  faces are not split any more once there are this many more.
/// @param interrupt may be null; once requested, the rest is left unsplit.
/// @return true when anything was split; `surface` is out of date then. Cost O(F + new faces).
bool RefineCreases(const Surface& surface, double longest, std::int64_t most_new,
                   RepairedMesh* repaired, Interrupt* interrupt = nullptr);

}  // namespace ccst::internal
