#pragma once

namespace ccst {

/// Changes whenever equal requests may give other samples. By itself, for little depends on it.
inline constexpr int kAlgorithmRevision = 7;

}  // namespace ccst
