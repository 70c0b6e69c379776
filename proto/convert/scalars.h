#pragma once

#include <Eigen/Core>

#include "absl/time/time.h"
#include "ccst/v1/mesh.pb.h"
#include "google/protobuf/duration.pb.h"
#include "google/protobuf/timestamp.pb.h"

namespace ccst {

/// Seconds as a Duration, rounded to nanoseconds; `seconds` is clamped to what a Duration holds
/// and 0 where it is not a number.
google::protobuf::Duration DurationToProto(double seconds);

/// Seconds of a Duration.
double SecondsFromProto(const google::protobuf::Duration& duration);

/// Rounded down to nanoseconds.
google::protobuf::Timestamp TimestampToProto(absl::Time time);

/// True for a valid Duration above 0.
bool IsPositiveDuration(const google::protobuf::Duration& duration);

v1::Vector3 ToProto(const Eigen::Vector3d& vector);
Eigen::Vector3d FromProto(const v1::Vector3& vector);

}  // namespace ccst
