#include "server/jobs/job_input.h"

#include <utility>

#include "core/base/status.h"
#include "server/base/mutex.h"
#include "server/base/without_throwing.h"

namespace ccst::server {
namespace {

// When decoding is given up.
struct End {
  std::stop_token stop;
  std::optional<Interrupt::Clock::time_point> deadline;
};

// How work ends that `end` cut off.
absl::Status Ended(const End& end) {
  if (end.stop.stop_requested()) return StoppedOnRequest();
  Interrupt interrupt(end.stop, end.deadline);
  interrupt.Requested();
  return interrupt.Error("the mesh and what belongs to it were decoded");
}

// What `decode` makes of the bytes under `sha256`, or the error of Ended() as soon as `end` says
// so; a decoder at work then goes on alone.
template <typename T>
absl::StatusOr<T> DecodeUnlessStopped(const InputSource& source, const End& end,
                                      const std::string& sha256,
                                      std::function<absl::StatusOr<T>(const std::string&)> decode) {
  struct Decoding {
    Mutex mutex;
    StoppableCondVar changed;
    bool done ABSL_GUARDED_BY(mutex) = false;
    absl::StatusOr<T> result ABSL_GUARDED_BY(mutex);
  };
  auto decoding = std::make_shared<Decoding>();
  // The grant goes last: by then what nobody waits for any more is freed.
  const auto run = [grant = source.grant, load = source.load, sha256, end,
                    decode = std::move(decode), decoding] {
    absl::StatusOr<T> result = WithoutThrowing("the computation", [&]() -> absl::StatusOr<T> {
      // Ended before its turn came: nobody waits for it.
      if (Interrupt(end.stop, end.deadline).Requested()) return Ended(end);
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
  const auto is_done = [&] { return decoding->done; };
  const bool done =
      end.deadline.has_value()
          ? decoding->changed.wait_until(decoding->mutex, end.stop, *end.deadline, is_done)
          : decoding->changed.wait(decoding->mutex, end.stop, is_done);
  if (!done) return Ended(end);
  return std::move(decoding->result);
}

}  // namespace

absl::StatusOr<JobInput> LoadInput(const JobSpec& spec, const RunDependencies& dependencies,
                                   const InputSource& source, const std::stop_token& stop,
                                   std::optional<Interrupt::Clock::time_point> deadline) {
  const End end = {stop, deadline};
  JobInput input;
  CCST_ASSIGN_OR_RETURN(input.mesh,
                        DecodeUnlessStopped<TriangleMesh>(
                            source, end, spec.mesh_sha256,
                            [decode = dependencies.decode, limits = dependencies.mesh_limits](
                                const std::string& bytes) { return decode(bytes, limits); }));
  if (spec.texture_sha256.empty()) return input;
  Image image;
  CCST_ASSIGN_OR_RETURN(
      image, DecodeUnlessStopped<Image>(source, end, spec.texture_sha256,
                                        [decode = dependencies.decode_image](
                                            const std::string& bytes) { return decode(bytes); }));
  input.image = std::make_shared<const Image>(std::move(image));
  return input;
}

absl::Status StoppedOnRequest() {
  return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "stopped on request");
}

}  // namespace ccst::server
