#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/base/mutex.h"
#include "server/store/blob_store.h"

namespace ccst::server {

/// The bytes of a mesh that a job needs and the store does not have.
struct HeldInput {
  std::string sha256;
  std::string bytes;

  /// The bytes as a blob of the store would be.
  static std::shared_ptr<const Blob> AsBlob(const std::shared_ptr<const HeldInput>& input);
};

/// Keeps small meshes of jobs that end with their callers in memory, so that such a job need not
/// wait for the disk before it computes. All together have a bound of their own, beside the memory
/// budget of jobs: those that wait for a worker must not keep others from running. Thread-safe.
class HeldInputs {
 public:
  explicit HeldInputs(std::int64_t most_bytes);

  /// Takes `bytes`, whose digest is `sha256`, until the last copy is gone. Null, and nothing is
  /// taken, where they are more than a sixteenth of all or do not fit beside the others.
  std::shared_ptr<const HeldInput> Hold(const std::string& sha256, std::string& bytes);

 private:
  struct Room {
    Mutex mutex;
    std::int64_t left_bytes ABSL_GUARDED_BY(mutex) = 0;
  };

  const std::int64_t most_bytes_of_one_;
  const std::shared_ptr<Room> room_;  // Shared with what is held, which may be there longer.
};

}  // namespace ccst::server
