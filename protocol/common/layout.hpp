// SPDX-License-Identifier: Apache-2.0
// Wire layouts as tables: one list of field offsets per message, used for reading and for writing.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "protocol/common/byte_reader.hpp"
#include "protocol/common/byte_writer.hpp"

namespace sonard {

/// One field. The member's type is its type on the wire: little-endian integers, IEEE-754 float and double.
template <class Owner, class Member>
struct Field {
  std::size_t offset;  ///< from the start of the message
  std::string_view name;
  Member Owner::*member;
};
template <class Owner, class Member>
Field(std::size_t, std::string_view, Member Owner::*) -> Field<Owner, Member>;

/// Bytes without a meaning: written as zero, skipped on reading.
template <std::size_t Size>
struct Spare {
  std::size_t offset;
};

/// Size in bytes of a member of this type on the wire. An optional member must be the last field.
template <class Member>
struct WireSize : std::integral_constant<std::size_t, sizeof(Member)> {
  static_assert(std::integral<Member> || std::floating_point<Member> || std::is_enum_v<Member>);
};
template <class Element, std::size_t N>
struct WireSize<std::array<Element, N>> : std::integral_constant<std::size_t, N * WireSize<Element>::value> {
};
template <class Inner>
struct WireSize<std::optional<Inner>> : WireSize<Inner> {};

template <class Owner, class Member>
constexpr std::size_t wire_size(const Field<Owner, Member>&) {
  return WireSize<Member>::value;
}
template <std::size_t Size>
constexpr std::size_t wire_size(const Spare<Size>&) {
  return Size;
}

/// A table is a type with three members:
///   size     bytes of the complete message
///   minimum  bytes that a receiver requires; fields beyond it keep their defaults if the message is shorter
///   fields   a tuple of Field and Spare in order of offset
/// WholeLayout is for messages that require all of their bytes.
template <std::size_t Size>
struct WholeLayout {
  static constexpr std::size_t size = Size;
  static constexpr std::size_t minimum = Size;
};

/// True if the fields of `Table` cover `start` to its size without gap or overlap.
template <class Table>
consteval bool layout_is_contiguous(std::size_t start) {
  std::size_t offset = start;
  bool contiguous = true;
  std::apply(
      [&](const auto&... field) {
        ((contiguous = contiguous && field.offset == offset, offset += wire_size(field)), ...);
      },
      Table::fields);
  return contiguous && offset == Table::size && Table::minimum <= Table::size;
}

/// Unsigned integer type with the bits of a floating-point type.
template <std::floating_point Value>
using BitsOf = std::conditional_t<sizeof(Value) == sizeof(std::uint32_t), std::uint32_t, std::uint64_t>;

// ---- Members on the wire, by type. Other types define read_value and write_value beside the type.

template <class Value>
requires std::integral<Value> || std::is_enum_v<Value>
void read_value(ByteReader& reader, std::string_view name, Value& value) {
  value = static_cast<Value>(reader.little_endian(WireSize<Value>::value, name));
}

template <std::floating_point Value>
void read_value(ByteReader& reader, std::string_view name, Value& value) {
  const auto bits = static_cast<BitsOf<Value>>(reader.little_endian(sizeof(Value), name));
  value = std::bit_cast<Value>(bits);
}

template <class Element, std::size_t N>
void read_value(ByteReader& reader, std::string_view name, std::array<Element, N>& values) {
  for (Element& value : values) {
    read_value(reader, name, value);
  }
}

template <std::size_t N>
void read_value(ByteReader& reader, std::string_view name, std::array<std::uint8_t, N>& values) {
  std::ranges::copy(reader.bytes(N, name), values.begin());
}

template <class Inner>
void read_value(ByteReader& reader, std::string_view name, std::optional<Inner>& value) {
  read_value(reader, name, value.emplace());
}

template <class Value>
requires std::integral<Value> || std::is_enum_v<Value>
void write_value(ByteWriter& writer, const Value& value) {
  writer.little_endian(static_cast<std::uint64_t>(value), WireSize<Value>::value);
}

template <std::floating_point Value>
void write_value(ByteWriter& writer, const Value& value) {
  writer.little_endian(std::bit_cast<BitsOf<Value>>(value), sizeof(Value));
}

template <class Element, std::size_t N>
void write_value(ByteWriter& writer, const std::array<Element, N>& values) {
  for (const Element& value : values) {
    write_value(writer, value);
  }
}

template <std::size_t N>
void write_value(ByteWriter& writer, const std::array<std::uint8_t, N>& values) {
  writer.bytes(values);
}

template <class Inner>
void write_value(ByteWriter& writer, const std::optional<Inner>& value) {
  if (value) {
    write_value(writer, *value);
  }
}

// ---- Fields by their table

/// Reads a field. A field beyond the minimum keeps its value if the message ends before the field does.
template <class Table, class Message, class Owner, class Member>
void read_field(ByteReader& reader, Message& message, const Field<Owner, Member>& field) {
  if (field.offset < Table::minimum || reader.remaining() >= wire_size(field)) {
    read_value(reader, field.name, message.*field.member);
  }
}

/// Skips spare bytes. Spare bytes beyond the minimum may be missing.
template <class Table, class Message, std::size_t Size>
void read_field(ByteReader& reader, Message&, const Spare<Size>& spare) {
  const std::size_t end = std::min(spare.offset + Size, std::max(spare.offset, Table::minimum));
  const std::size_t insisted = end - spare.offset;
  reader.skip(std::max(insisted, std::min(Size, reader.remaining())), "spare");
}

template <class Message, class Owner, class Member>
void write_field(ByteWriter& writer, const Message& message, const Field<Owner, Member>& field) {
  write_value(writer, message.*field.member);
}

template <class Message, std::size_t Size>
void write_field(ByteWriter& writer, const Message&, const Spare<Size>&) {
  writer.zeros(Size);
}

/// Reads `message` by `Table`; `reader` must be at the first field.
template <class Table, class Message>
void read_fields(ByteReader& reader, Message& message) {
  std::apply([&](const auto&... field) { (read_field<Table>(reader, message, field), ...); }, Table::fields);
}

template <class Table, class Message>
void write_fields(ByteWriter& writer, const Message& message) {
  std::apply([&](const auto&... field) { (write_field(writer, message, field), ...); }, Table::fields);
}

}  // namespace sonard
