#pragma once

#include <string_view>

namespace ccst {

/// Semantic version of the project, for example `0.1.0`.
std::string_view ProjectVersion();

/// Source revision this was built from, with `-modified` where files differed from it;
/// `unknown` outside a checkout.
std::string_view SourceRevision();

}  // namespace ccst
