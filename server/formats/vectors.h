#pragma once

#include <Eigen/Core>

#include "ccst/store/v1/record.pb.h"

namespace ccst::server::internal {

inline void Write(const Eigen::Vector3d& vector, store::v1::Vector& message) {
  message.set_x(vector.x());
  message.set_y(vector.y());
  message.set_z(vector.z());
}

inline Eigen::Vector3d Read(const store::v1::Vector& message) {
  return {message.x(), message.y(), message.z()};
}

}  // namespace ccst::server::internal
