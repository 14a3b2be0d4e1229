// SPDX-License-Identifier: Apache-2.0
// Converts layouts (protocol/common/layout.hpp) to the Lua of a field table; shared by all devices. All
// functions append to the text in their first argument.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>

#include "protocol/common/layout.hpp"

namespace sonard::wireshark {

/// Specialise it, with `type`, for a member that has its own table on the wire. The member is then replaced
/// by the table's fields, named MEMBER_FIELD.
template <class Member>
struct InnerTable {};

/// The wire format of any other member: `count` values of `size` bytes each.
template <class Member>
struct Shape {
  static constexpr std::size_t size = WireSize<Member>::value;
  static constexpr std::size_t count = 1;
};
template <class Element, std::size_t N>
struct Shape<std::array<Element, N>> {
  static constexpr std::size_t size = WireSize<Element>::value;
  static constexpr std::size_t count = N;
};

// ---- One field: { offset, size, name, count }; a count of 1 is left out

inline void append_field(std::string& lua, std::size_t offset, std::size_t size, const std::string& name,
                         std::size_t count) {
  lua += "      { " + std::to_string(offset) + ", " + std::to_string(size) + ", \"" + name + "\"";
  if (count != 1) {
    lua += ", " + std::to_string(count);
  }
  lua += " },\n";
}

template <class Table>
void append_fields(std::string& lua, std::size_t base, const std::string& prefix);

template <class Message, class Member>
void append(std::string& lua, std::size_t base, const std::string& prefix,
            const Field<Message, Member>& field) {
  const std::string name = prefix + std::string{field.name};
  if constexpr (requires { typename InnerTable<Member>::type; }) {
    append_fields<typename InnerTable<Member>::type>(lua, base + field.offset, name + "_");
  } else {
    append_field(lua, base + field.offset, Shape<Member>::size, name, Shape<Member>::count);
  }
}

template <std::size_t Size>
void append(std::string&, std::size_t, const std::string&, const Spare<Size>&) {}

template <class Table>
void append_fields(std::string& lua, std::size_t base, const std::string& prefix) {
  std::apply([&](const auto&... field) { (append(lua, base, prefix, field), ...); }, Table::fields);
}

// ---- Messages

template <class Table>
void append_message(std::string& lua, std::string_view name) {
  lua += "    " + std::string{name} + " = { size = " + std::to_string(Table::size) +
         ", minimum = " + std::to_string(Table::minimum) + ", fields = {\n";
  append_fields<Table>(lua, 0, "");
  lua += "    } },\n";
}

/// @param number identifies the message: its type or ID
inline void append_type(std::string& lua, unsigned number, std::string_view name) {
  lua += "    [" + std::to_string(number) + "] = \"" + std::string{name} + "\",\n";
}

template <class... Messages, class Each>
void for_each_message(const std::variant<Messages...>*, const Each& each) {
  (each(std::type_identity<Messages>{}), ...);
}
/// Calls `each` with the std::type_identity of each alternative of a variant, in order.
template <class Variant, class Each>
void for_each_message(const Each& each) {
  for_each_message(static_cast<const Variant*>(nullptr), each);
}

/// The start of a file, up to the brace that opens its only table.
inline std::string table_head(std::string_view device) {
  return "-- Made by wireshark_fields from protocol/" + std::string{device} +
         "/layout.hpp; not to be edited.\n"
         "-- A field is { offset, size in bytes, name, number of values if there are several }, "
         "little-endian.\n"
         "return {\n";
}

}  // namespace sonard::wireshark
