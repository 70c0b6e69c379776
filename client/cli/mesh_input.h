#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/io/mesh_file.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"

namespace ccst::cli {

/// A mesh as it was read, and as it is sampled.
struct MeshInput {
  MeshFile file;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  TriangleMesh wire;      ///< What a server decodes: 32-bit floats relative to `origin`.
  std::string draco;      ///< `wire` encoded; empty when not asked for.
  double max_move = 0.0;  ///< Farthest a vertex of a face moved by quantisation [mesh unit].
};

/// Whether the encoded mesh will be needed.
enum class Transport { kLocal, kRemote };

/// Reads `path` (`-`: standard input, whose format is recognised by its first bytes) and makes of
/// it what a server would compute on.
/// @errors those of ReadMeshFile(), ToWirePrecision() and EncodeDraco()
absl::StatusOr<MeshInput> ReadMeshInput(const std::string& path,
                                        std::optional<int> quantization_bits, Transport transport);

/// What of the file was not taken as it stands, a line each for people: `2 faces with fewer than
/// three corners are skipped`. Empty when there is nothing to say.
std::string ReportText(const ReadReport& report);

/// Gives samples the numbers that faces have in the file, and where faces are polygons the corners
/// that the barycentrics belong to: those of their triangles otherwise.
/// @param face_source   as in MeshFile; empty leaves the samples as they are.
/// @param face_corners  as in MeshFile
void NameOwnFaces(const std::vector<std::int32_t>& face_source,
                  const std::vector<Eigen::Vector3i>& face_corners, SampleSet& samples);

/// The format that `bytes` begin like; OBJ, which has no mark, when like no other.
MeshFormat RecogniseFormat(std::string_view bytes);

}  // namespace ccst::cli
