// SPDX-License-Identifier: Apache-2.0
// JSON as the commands and reports of the device use it: a stream of objects, and their values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace sonard::dvl_a50 {

/// A JSON value.
struct Json {
  using List = std::vector<Json>;
  using Members = std::vector<std::pair<std::string, Json>>;
  std::variant<std::nullptr_t, bool, double, std::string, List, Members> value = nullptr;

  /// The last member of this name; null if this is no object or has no such member.
  const Json* find(std::string_view name) const;
  /// The value if it has this type, else null.
  template <class T>
  const T* as() const {
    return std::get_if<T>(&value);
  }
};

/// @return nullopt if `text` is not one JSON value, is nested deeper than 16 levels, or has a number that is
/// not finite
std::optional<Json> parse_json(std::string_view text);

/// A text with quotes.
std::string json_text(std::string_view text);
/// A number that reads back as the same double and has a point or an exponent.
std::string json_number(double value);

/// The objects of a stream, whatever separates them (1).
class JsonStream {
 public:
  static constexpr std::size_t most_bytes = 64'000;  ///< of an unfinished object

  void append(std::span<const std::uint8_t> bytes);
  /// The next text from a brace to its matching brace; nullopt: none is complete.
  std::optional<std::string> next();
  /// True if an unfinished object is too long: the stream is of no use any more.
  bool overflowed() const { return overflowed_; }
  std::uint64_t dropped() const { return dropped_; }  ///< bytes outside objects, except blanks

 private:
  std::string rest_;
  std::size_t scanned_ = 0;  ///< of rest_
  int depth_ = 0;
  bool in_text_ = false, escaped_ = false, overflowed_ = false;
  std::uint64_t dropped_ = 0;
};

}  // namespace sonard::dvl_a50
