#include "proto/convert/scalars.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ccst {
namespace {

constexpr double kMaxDurationSeconds = 315'576'000'000.0;  // google.protobuf.Duration's range.
constexpr double kNanosPerSecond = 1e9;

}  // namespace

google::protobuf::Duration DurationToProto(double seconds) {
  google::protobuf::Duration duration;
  if (std::isnan(seconds)) return duration;
  const double clamped = std::clamp(seconds, -kMaxDurationSeconds, kMaxDurationSeconds);
  double whole = std::trunc(clamped);
  double nanos = std::round((clamped - whole) * kNanosPerSecond);
  if (std::abs(nanos) >= kNanosPerSecond) {
    whole += std::copysign(1.0, nanos);
    nanos = 0.0;
  }
  duration.set_seconds(static_cast<std::int64_t>(whole));
  duration.set_nanos(static_cast<std::int32_t>(nanos));
  return duration;
}

double SecondsFromProto(const google::protobuf::Duration& duration) {
  return static_cast<double>(duration.seconds()) +
         static_cast<double>(duration.nanos()) / kNanosPerSecond;
}

google::protobuf::Timestamp TimestampToProto(absl::Time time) {
  google::protobuf::Timestamp timestamp;
  const std::int64_t seconds = absl::ToUnixSeconds(time);
  timestamp.set_seconds(seconds);
  timestamp.set_nanos(
      static_cast<std::int32_t>(absl::ToInt64Nanoseconds(time - absl::FromUnixSeconds(seconds))));
  return timestamp;
}

bool IsPositiveDuration(const google::protobuf::Duration& duration) {
  constexpr std::int64_t kMaxSeconds = 315'576'000'000;
  return duration.seconds() >= 0 && duration.seconds() <= kMaxSeconds && duration.nanos() >= 0 &&
         duration.nanos() < 1'000'000'000 && (duration.seconds() > 0 || duration.nanos() > 0);
}

v1::Vector3 ToProto(const Eigen::Vector3d& vector) {
  v1::Vector3 message;
  message.set_x(vector.x());
  message.set_y(vector.y());
  message.set_z(vector.z());
  return message;
}

Eigen::Vector3d FromProto(const v1::Vector3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace ccst
