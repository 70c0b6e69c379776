#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "server/net/rate_bucket.h"

namespace ccst::server {

/// The head of an HTTP/2 frame.
struct FrameHead {
  std::size_t length = 0;  ///< Bytes of the payload.
  int type = 0;
  int flags = 0;
  std::uint32_t stream = 0;
};

/// Finds the heads of frames in bytes that come in pieces.
class FrameCursor {
 public:
  /// Goes over `bytes` from `at` on, until behind the last byte of a head, which it returns, or to
  /// the end.
  std::optional<FrameHead> Next(std::span<const char> bytes, std::size_t& at);

 private:
  static constexpr std::size_t kHeadBytes = 9;
  std::array<unsigned char, kHeadBytes> head_ = {};
  std::size_t head_size_ = 0;
  std::size_t payload_left_ = 0;
};

/// What one connection may ask of the HTTP/2 implementation behind it. That of gRPC 1.51 bounds
/// neither how many streams a peer opens and resets nor how long a block of headers is, and its
/// memory grows with both; see SECURITY.md.
///
/// Nothing that a well-behaved client does is refused. Resets and frames that carry nothing are
/// slowed down to a rate; a broken beginning and an endless block of headers end the connection.
/// Not thread-safe.
class FrameGuard {
 public:
  /// Bytes and frames of one block of headers. gRPC refuses metadata over 8 KiB by itself, with a
  /// message; a block may be a little longer than what it stands for.
  static constexpr std::size_t kMaxHeaderBytes = 32 << 10;
  static constexpr int kMaxHeaderFrames = 8;
  /// Streams reset, by either side: as many at once as a connection may have, then a rate.
  static constexpr double kResetBurst = 1024;
  static constexpr double kResetsPerSecond = 100;
  /// SETTINGS, PING, PRIORITY, empty DATA and what this version of the protocol does not know.
  static constexpr double kControlBurst = 1000;
  static constexpr double kControlsPerSecond = 200;
  /// All others but DATA of some size.
  static constexpr double kFrameBurst = 20'000;
  static constexpr double kFramesPerSecond = 20'000;

  /// `take_reset`, if any, takes a reset from what all connections of the address share: as
  /// RateBucket::Take().
  explicit FrameGuard(std::function<double(double now)> take_reset);

  /// What becomes of bytes from the client.
  struct Verdict {
    std::size_t allowed = 0;        ///< So many of them may go on, now.
    double resume_at = 0.0;         ///< The others may be shown again then; `now` when all may go.
    std::string_view offence = {};  ///< Not empty: why the connection must end.
  };

  /// Judges `bytes`, which begin with what the last verdict did not allow. Not before its
  /// `resume_at`. Linear in bytes.
  Verdict Inspect(std::span<const char> bytes, double now);

  /// Takes note of bytes to the client: a client can also make the server reset streams.
  void InspectAnswer(std::span<const char> bytes, double now);

  /// True once the preface and the head of a first frame came.
  bool has_begun() const { return has_begun_; }
  /// True once the client asked for something.
  bool has_requests() const { return has_requests_; }

 private:
  std::string_view Judge(const FrameHead& head, double now);
  std::string_view JudgeHeaders(const FrameHead& head);
  void HoldUntil(double time) { held_until_ = std::max(held_until_, time); }
  void CountReset(double now);

  const std::function<double(double)> take_reset_;
  RateBucket resets_;
  RateBucket controls_;
  RateBucket frames_;
  FrameCursor requests_;
  FrameCursor answers_;
  double held_until_ = 0.0;
  bool holds_byte_ = false;  // The last byte of a head that was judged and may not go on yet.
  std::size_t preface_size_ = 0;
  bool has_begun_ = false;
  bool has_requests_ = false;
  std::uint32_t open_block_ = 0;  // Stream of a block of headers that goes on; 0: none.
  std::size_t block_bytes_ = 0;
  int block_frames_ = 0;
};

}  // namespace ccst::server
