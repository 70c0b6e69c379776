#pragma once

#include <cstdint>
#include <string_view>

namespace ccst::server {

/// What jobs tell while they live; told on their threads, so it must not block. The words are few
/// and fixed, never something a caller sent.
class JobObserver {
 public:
  virtual ~JobObserver() = default;

  /// A phase such as `decoding` or `relaxing` of some job was over after `seconds`.
  virtual void OnPhase(std::string_view phase, double seconds) = 0;
  /// A job finished one alternation.
  virtual void OnAlternation() = 0;
  /// A job ended in `state`, for example `succeeded`, `seconds` after it was submitted.
  virtual void OnEnd(std::string_view state, double seconds) = 0;
  /// A job was asked to stop: by `caller`, `drain` or `abandoned`, when nobody watches it.
  virtual void OnCancel(std::string_view reason) = 0;
  /// Something stored by its digest was looked for: `result`.
  virtual void OnCacheLookup(std::string_view cache, bool hit) = 0;
};

/// An observer that nothing comes of.
class SilentJobObserver final : public JobObserver {
 public:
  void OnPhase(std::string_view /*phase*/, double /*seconds*/) override {}
  void OnAlternation() override {}
  void OnEnd(std::string_view /*state*/, double /*seconds*/) override {}
  void OnCancel(std::string_view /*reason*/) override {}
  void OnCacheLookup(std::string_view /*cache*/, bool /*hit*/) override {}
};

}  // namespace ccst::server
