#pragma once

#include <cstdint>

#include "core/mesh/triangle_mesh.h"

/// Samples `mesh` with few samples, as a job would, by the method and with the options that
/// `choice` tells; aborts, saying why, when the job breaks a promise or takes more than a job of
/// this size may.
void SampleFew(const ccst::TriangleMesh& mesh, std::uint32_t choice);
