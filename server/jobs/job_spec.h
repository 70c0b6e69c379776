#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/sampling/sampling.h"

namespace ccst::server {

/// A request for samples, checked.
struct JobSpec {
  std::string owner;  ///< Who may see the job; empty: everybody.
  std::string share;  ///< Among whom the workers are shared fairly.
  std::string request_id;
  std::string display_name;
  std::map<std::string, std::string> labels;
  std::string mesh_sha256;
  std::string texture_sha256;             ///< The image of a texture density; empty: none.
  SamplingOptions options;                ///< With defaults filled in, without an image.
  std::optional<Eigen::Vector3d> origin;  ///< What the caller subtracted from all positions.
  /// The job is cancelled when nobody watched it for this long [s].
  std::optional<double> abandon_seconds;
  bool ends_with_caller = false;  ///< Cancelled when its first watcher goes, or the server does.
  bool skip_cache_lookup = false;
};

/// Names everything that determines the samples of a run that no time limit cut, and the revision
/// of the algorithm: SHA-256 over a layout of our own, in which doubles are their bits.
std::string SpecDigest(const JobSpec& spec);

}  // namespace ccst::server
