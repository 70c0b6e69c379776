#pragma once

#include <string_view>

#include "absl/status/status.h"

namespace ccst::server {

/// The exception that is being handled, as an error of `what`: RESOURCE_EXHAUSTED OUT_OF_MEMORY or
/// INTERNAL INTERNAL. Called in a catch clause alone.
absl::Status CaughtError(std::string_view what);

/// What `compute`, a function without arguments that returns an absl::Status or StatusOr, returns;
/// what it throws as an error. Tasks of an Executor must not throw.
/// @param what  who needs the memory or broke, for people: `the call`
template <typename Compute>
auto WithoutThrowing(std::string_view what, const Compute& compute) -> decltype(compute()) {
  try {
    return compute();
  } catch (...) {
    return CaughtError(what);
  }
}

}  // namespace ccst::server
