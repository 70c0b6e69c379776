#pragma once

#include <optional>
#include <string_view>

#include "core/base/status.h"

namespace ccst {

/// The reason of this name; empty for one that this version does not know.
std::optional<ErrorReason> FindErrorReason(std::string_view name);

}  // namespace ccst
