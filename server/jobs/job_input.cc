#include "server/jobs/job_input.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/base/status.h"
#include "server/base/mutex.h"
#include "server/jobs/without_throwing.h"

namespace ccst::server {
namespace {

// What a mesh says of itself stands in its first bytes, but for long metadata.
constexpr std::int64_t kHeaderBytes = std::int64_t{64} << 10;

// What `decode` makes of the bytes under `sha256`, or CANCELLED as soon as `stop` is requested; a
// decoder at work then goes on alone.
template <typename T>
absl::StatusOr<T> DecodeUnlessStopped(const InputSource& source, const std::stop_token& stop,
                                      const std::string& sha256,
                                      std::function<absl::StatusOr<T>(const std::string&)> decode) {
  struct Decoding {
    Mutex mutex;
    CondVar changed;
    bool done ABSL_GUARDED_BY(mutex) = false;
    absl::StatusOr<T> result ABSL_GUARDED_BY(mutex);
  };
  auto decoding = std::make_shared<Decoding>();
  // The grant goes last: by then what nobody waits for any more is freed.
  const auto run = [grant = source.grant, load = source.load, sha256, stop,
                    decode = std::move(decode), decoding] {
    absl::StatusOr<T> result = WithoutThrowing<T>([&]() -> absl::StatusOr<T> {
      // Stopped before its turn came: nobody waits for it.
      if (stop.stop_requested()) return StoppedOnRequest();
      std::string bytes;
      CCST_ASSIGN_OR_RETURN(bytes, load(sha256));
      return decode(bytes);
    });
    MutexLock lock(decoding->mutex);
    decoding->result = std::move(result);
    decoding->done = true;
    decoding->changed.notify_all();
  };
  if (!source.decoders.Run(run)) run();
  MutexLock lock(decoding->mutex);
  if (!decoding->changed.wait(decoding->mutex, stop, [&] { return decoding->done; })) {
    return StoppedOnRequest();
  }
  return std::move(decoding->result);
}

}  // namespace

absl::StatusOr<JobInput> LoadInput(const JobSpec& spec, const RunDependencies& dependencies,
                                   const InputSource& source, const std::stop_token& stop) {
  JobInput input;
  CCST_ASSIGN_OR_RETURN(input.mesh,
                        DecodeUnlessStopped<TriangleMesh>(
                            source, stop, spec.mesh_sha256,
                            [decode = dependencies.decode, limits = dependencies.mesh_limits](
                                const std::string& bytes) { return decode(bytes, limits); }));
  if (spec.texture_sha256.empty()) return input;
  Image image;
  CCST_ASSIGN_OR_RETURN(
      image, DecodeUnlessStopped<Image>(source, stop, spec.texture_sha256,
                                        [decode = dependencies.decode_image](
                                            const std::string& bytes) { return decode(bytes); }));
  input.image = std::make_shared<const Image>(std::move(image));
  return input;
}

absl::StatusOr<MeshCounts> CountMesh(const BlobStore& blobs, const std::string& sha256,
                                     const RunDependencies& dependencies) {
  auto opened = blobs.Open(sha256);
  if (absl::IsNotFound(opened.status())) {
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshMissing,
                     "the mesh meshes/" + sha256 + " is not stored");
  }
  if (!opened.ok()) return opened.status();
  const Blob& blob = **opened;
  const std::int64_t size = blob.size_bytes();
  const auto count = [&](std::int64_t length) -> absl::StatusOr<MeshCounts> {
    std::string start(static_cast<std::size_t>(length), '\0');
    CCST_RETURN_IF_ERROR(blob.Read(0, start));
    return dependencies.count(start, size, dependencies.mesh_limits);
  };
  auto counts = count(std::min(size, kHeaderBytes));
  if (!counts.ok() && size > kHeaderBytes) counts = count(size);
  return counts;
}

absl::Status StoppedOnRequest() {
  return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "stopped on request");
}

}  // namespace ccst::server
