// SPDX-License-Identifier: Apache-2.0
// The field tables of any device of the Ping protocol, as Lua.
#pragma once

#include <string>
#include <string_view>
#include <type_traits>

#include "clients/wireshark/lua_tables.hpp"
#include "protocol/ping/codec.hpp"

namespace sonard::wireshark {

template <class Direction>
void append_types(std::string& lua) {
  for_each_message<Direction>([&]<class Message>(std::type_identity<Message>) {
    if constexpr (!std::is_same_v<Message, ping::Unknown>) {
      append_type(lua, static_cast<unsigned>(Message::id), name_of(Message::id));
    }
  });
}

template <class Message, class... Messages>
constexpr bool is_in(const std::variant<Messages...>*) {
  return (std::is_same_v<Message, Messages> || ...);
}

/// Appends messages with fields. @tparam Before messages that were appended already
template <template <class> class Layout, class Direction, class Before = std::variant<ping::Unknown>>
void append_messages(std::string& lua) {
  for_each_message<Direction>([&]<class Message>(std::type_identity<Message>) {
    if constexpr (ping::HasLayout<Layout, Message> && !is_in<Message>(static_cast<const Before*>(nullptr))) {
      append_message<Layout<Message>>(lua, name_of(Message::id));
    }
  });
}

/// The text of sonard_DEVICE_fields.lua.
template <template <class> class Layout, class Command, class Report>
std::string ping_field_tables(std::string_view device) {
  std::string lua = table_head(device) + "  commands = {\n";
  append_types<Command>(lua);
  lua += "  },\n  reports = {\n";
  append_types<Report>(lua);
  lua += "  },\n  messages = {\n";
  append_messages<Layout, Command>(lua);
  append_messages<Layout, Report, Command>(lua);
  return lua + "  },\n}\n";
}

}  // namespace sonard::wireshark
