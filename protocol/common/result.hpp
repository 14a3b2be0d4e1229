// SPDX-License-Identifier: Apache-2.0
// A value or an error, for functions that can fail in normal operation.
#pragma once

#include <cassert>
#include <concepts>
#include <type_traits>
#include <utility>
#include <variant>

namespace sonard {

/// Holds either a T or an E. Both convert implicitly:
///   Result<int, WireError> parse(...) { if (bad) return WireError{...}; return 42; }
/// Check has_value() first: access to the missing one asserts in debug builds, else it is undefined.
template <class T, class E>
class [[nodiscard]] Result {
  static_assert(!std::is_same_v<T, E> && !std::is_reference_v<T> && !std::is_reference_v<E>);

 public:
  using value_type = T;
  using error_type = E;

  template <class U>
  requires std::convertible_to<U&&, T> &&(!std::same_as<std::remove_cvref_t<U>, Result>)Result(U&& value)
      : state_(std::in_place_index<0>, std::forward<U>(value)) {}

  template <class U>
  requires std::convertible_to<U&&, E> &&
      (!std::convertible_to<U&&, T>)&&(!std::same_as<std::remove_cvref_t<U>, Result>)Result(U&& error)
      : state_(std::in_place_index<1>, std::forward<U>(error)) {}

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  T& value() & { return *checked(std::get_if<0>(&state_)); }
  const T& value() const& { return *checked(std::get_if<0>(&state_)); }
  T&& value() && { return std::move(*checked(std::get_if<0>(&state_))); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const E& error() const { return *checked(std::get_if<1>(&state_)); }

  template <class U>
  T value_or(U&& fallback) const& {
    return has_value() ? value() : static_cast<T>(std::forward<U>(fallback));
  }

  friend bool operator==(const Result&, const Result&) = default;

 private:
  template <class P>
  static P* checked(P* held) {
    assert(held != nullptr);
    return held;
  }

  std::variant<T, E> state_;
};

}  // namespace sonard
