#pragma once

#include <string>

#include <google/protobuf/message.h>

#include "core/sampling/options.h"
#include "proto/convert/options.h"
#include "proto/convert/violations.h"

namespace ccst {

/// Sets the fields of `message` that the table of options (core/sampling/option_table.h) names for
/// `options`. Left out are those that the message does not have, the source of a density, which is
/// the kind of its message, and images.
void WriteOptionFields(const SamplingOptions& options, google::protobuf::Message& message);
void WriteOptionFields(const DensityOptions& options, google::protobuf::Message& message);

/// The reverse. What `message` leaves out stays as it is in `options`, but not over the limits.
/// Adds every value that is out of its range to `violations`, under `prefix`, which ends in a dot
/// or is empty.
void ReadOptionFields(const google::protobuf::Message& message, const RequestLimits& limits,
                      const std::string& prefix, Violations& violations, SamplingOptions& options);
void ReadOptionFields(const google::protobuf::Message& message, const RequestLimits& limits,
                      const std::string& prefix, Violations& violations, DensityOptions& options);

}  // namespace ccst
