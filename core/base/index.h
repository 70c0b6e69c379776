#pragma once

#include <cstdint>

namespace ccst {

/// An index of one kind of things, told from those of others by its tag; -1 is none. It costs what
/// the number costs. It turns into the number by itself, for subscripts and arithmetic, but a
/// number or an index of another kind becomes one only where that is said.
template <typename Tag>
class Index {
 public:
  constexpr Index() = default;
  constexpr explicit Index(std::int32_t value) : value_(value) {}

  constexpr operator std::int32_t() const { return value_; }  // NOLINT(google-explicit-constructor)

 private:
  std::int32_t value_ = -1;
};

}  // namespace ccst
