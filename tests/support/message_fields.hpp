// SPDX-License-Identifier: Apache-2.0
// The fields in tests/data/DEVICE/messages.json as members of a device's messages. A test takes the fields
// out of their object one by one. A field that is missing throws; fields that are left over fail the test.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <concepts>
#include <list>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "protocol/common/layout.hpp"
#include "tests/support/messages.hpp"

namespace sonard::testing {

using Json = nlohmann::json;

struct Message {
  std::string name;
  bool from_head = false;
  std::string message;  ///< its name in the protocol
  Bytes bytes;
  Json fields;             ///< what it means: groups of fields, and fields outside a group
  Json wireshark;          ///< values that only the dissector shows
  bool is_written = true;  ///< false: an encoder writes this meaning in another form
  bool is_cut = false;     ///< true: only the first bytes of a message
};

/// Names the case in test output.
inline void PrintTo(const Message& message, std::ostream* out) {
  *out << message.name;
}

/// All messages of a device, sorted by name.
const std::vector<Message>& messages_of(std::string_view device);
const Message& message_of(std::string_view device, std::string_view name);

/// A hexadecimal text, or a list of them.
Bytes bytes_of(const Json& json);

/// A number, a hexadecimal number ("0x1e"), or an IPv4 address.
inline std::uint64_t integer_of(const Json& json) {
  if (!json.is_string()) {
    return json.get<std::uint64_t>();
  }
  const auto text = json.get<std::string>();
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (std::sscanf(text.c_str(), "%u.%u.%u.%u", &a, &b, &c, &d) == 4) {
    return std::uint64_t{a} << 24 | b << 16 | c << 8 | d;
  }
  return std::stoull(text, nullptr, 16);
}

inline Json take(Json& object, const std::string& name) {
  Json value = object.at(name);
  object.erase(name);
  return value;
}

// ---- Members from JSON, by type. Other types define `set` beside the type.

template <class Value>
requires std::integral<Value> || std::is_enum_v<Value>
void set(Value& value, const Json& json) {
  value = static_cast<Value>(integer_of(json));
}

template <std::floating_point Value>
void set(Value& value, const Json& json) {
  value = json.get<Value>();
}

template <class Element>
void set(std::vector<Element>& values, const Json& json) {
  values.resize(json.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    set(values[i], json[i]);
  }
}

inline void set(Bytes& bytes, const Json& json) {
  bytes = bytes_of(json);
}

/// A view, whose bytes live as long as the program.
inline void set(std::span<const std::uint8_t>& view, const Json& json) {
  static std::list<Bytes> storage;
  view = storage.emplace_back(bytes_of(json));
}

template <class Element, std::size_t N>
void set(std::array<Element, N>& values, const Json& json) {
  std::vector<Element> read;
  set(read, json);
  ASSERT_EQ(read.size(), N);
  std::ranges::copy(read, values.begin());
}

template <std::size_t N>
void set(std::array<std::uint8_t, N>& values, const Json& json) {
  const Bytes read = json.is_string() || json.at(0).is_string() ? bytes_of(json) : json.get<Bytes>();
  ASSERT_EQ(read.size(), N);
  std::ranges::copy(read, values.begin());
}

template <class Message, class Owner, class Member>
void take_field(Json& group, Message& message, const Field<Owner, Member>& field) {
  set(message.*field.member, take(group, std::string{field.name}));
}

/// A field that a message may lack.
template <class Message, class Owner, class Inner>
void take_field(Json& group, Message& message, const Field<Owner, std::optional<Inner>>& field) {
  const std::string name{field.name};
  (message.*field.member).reset();
  if (group.contains(name)) {
    set((message.*field.member).emplace(), take(group, name));
  }
}

template <class Message, std::size_t Size>
void take_field(Json&, Message&, const Spare<Size>&) {}

/// Sets the members that a layout table names from the group `name`, and removes the group. A message without
/// fields has no group.
template <class Table, class Message>
void take_fields(Json& fields, const std::string& name, Message& message) {
  Json group = fields.contains(name) ? take(fields, name) : Json::object();
  std::apply([&](const auto&... field) { (take_field(group, message, field), ...); }, Table::fields);
  EXPECT_TRUE(group.empty()) << name << " " << group;
}

/// The message that the fields of `example` describe, in the alternative of `decoded`. Expects both to be
/// equal.
/// @param take takes the fields of one message: void(Json& fields, Alternative& message)
template <class Variant, class Take>
Variant expect_fields(const Message& example, const Variant& decoded, const Take& take) {
  Json fields = example.fields;
  Variant described = decoded;
  std::visit(
      [&]<class Alternative>(Alternative& message) {
        message = Alternative{};
        take(fields, message);
      },
      described);
  EXPECT_TRUE(fields.empty()) << "of no message: " << fields;
  EXPECT_TRUE(decoded == described) << "the bytes mean other values than " << example.fields;
  return described;
}

/// Expects that the messages of a device in one direction are all alternatives of `Variant` but `left_out`.
template <class Variant, class Decode>
void expect_every_alternative(const std::string& device, bool from_head, const Decode& decode,
                              std::size_t left_out) {
  std::set<std::size_t> seen;
  for (const Message& message : messages_of(device)) {
    if (message.from_head == from_head && !message.is_cut) {
      seen.insert(decode(message.bytes).value().index());
    }
  }
  EXPECT_EQ(seen.size(), std::variant_size_v<Variant> - left_out);
}

/// Messages of a device that are complete, as parameters of a test.
inline std::vector<Message> complete_messages(const std::string& device) {
  std::vector<Message> messages = messages_of(device);
  std::erase_if(messages, [](const Message& message) { return message.is_cut; });
  return messages;
}

inline std::string message_name(const ::testing::TestParamInfo<Message>& info) {
  return info.param.name;
}

}  // namespace sonard::testing
