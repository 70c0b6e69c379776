#pragma once

#include <cstddef>
#include <type_traits>

namespace ccst {
namespace internal {

// Stand for a field of any class and for any other field. They are two, since a class that is made
// from a number, such as std::optional<double>, could be made from a single one in two ways.
struct AnyClass {
  template <typename Field>
  requires std::is_class_v<Field>
  operator Field() const;  // NOLINT(google-explicit-constructor): that is its purpose.
};
struct AnyScalar {
  template <typename Field>
  requires std::is_scalar_v<Field>
  operator Field() const;  // NOLINT(google-explicit-constructor): that is its purpose.
};

template <typename Aggregate, typename... Fields>
consteval std::size_t FieldCountFrom() {
  if constexpr (requires { Aggregate{Fields{}..., AnyClass{}}; }) {
    return FieldCountFrom<Aggregate, Fields..., AnyClass>();
  } else if constexpr (requires { Aggregate{Fields{}..., AnyScalar{}}; }) {
    return FieldCountFrom<Aggregate, Fields..., AnyScalar>();
  } else {
    return sizeof...(Fields);
  }
}

}  // namespace internal

/// How many fields a struct has that is initialised by braces and has neither bases nor arrays. For
/// static_assert: a list that must name every field stops compiling when one is added.
template <typename Aggregate>
consteval std::size_t FieldCount() {
  static_assert(std::is_aggregate_v<Aggregate>);
  return internal::FieldCountFrom<Aggregate>();
}

}  // namespace ccst
