#pragma once

#include <string>

/// Checks of what only a mistake in the program can break. They are there in builds with
/// -DCCST_ASSERTIONS=ON (the presets dev, asan-ubsan, tsan, fuzz and coverage) and cost nothing in
/// others, where their arguments are compiled but not evaluated. What callers or files can get
/// wrong is an error as a value instead (core/base/status.h).

namespace ccst {

#ifdef CCST_ASSERTIONS
inline constexpr bool kAssertions = true;
#else
inline constexpr bool kAssertions = false;
#endif

namespace internal {

/// Says on standard error what does not hold and where, then aborts.
[[noreturn]] void FailAssertion(const char* file, int line, const std::string& what);

}  // namespace internal
}  // namespace ccst

/// Ends the program unless `condition` holds.
#define CCST_ASSERT(condition)         \
  (!::ccst::kAssertions || (condition) \
       ? static_cast<void>(0)          \
       : ::ccst::internal::FailAssertion(__FILE__, __LINE__, #condition))

/// Ends the program unless `fault`, which a FindFault() returned, is empty.
#define CCST_ASSERT_NO_FAULT(fault)                                               \
  do {                                                                            \
    if constexpr (::ccst::kAssertions) {                                          \
      if (const std::string found = (fault); !found.empty()) {                    \
        ::ccst::internal::FailAssertion(__FILE__, __LINE__, #fault ": " + found); \
      }                                                                           \
    }                                                                             \
  } while (false)
