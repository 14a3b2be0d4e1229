// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>
#include <type_traits>

#include "clients/wireshark/lua_tables.hpp"
#include "protocol/ping1d/layout.hpp"

namespace sonard::wireshark {
namespace {

using ping1d::MessageId;

std::string_view name_of_common(ping::CommonId id) {
  using enum ping::CommonId;
  switch (id) {
    case ack:
      return "ack";
    case nack:
      return "nack";
    case ascii_text:
      return "ascii_text";
    case device_information:
      return "device_information";
    case protocol_version:
      return "protocol_version";
    case general_request:
      return "general_request";
    case set_common_device_id:
      return "set_common_device_id";
  }
  return "unknown";
}

template <class Message>
std::string_view name() {
  if constexpr (std::is_same_v<const MessageId, decltype(Message::id)>) {
    return ping1d::name_of(Message::id);
  } else {
    return name_of_common(Message::id);
  }
}

template <class Direction>
void append_types(std::string& lua) {
  for_each_message<Direction>([&]<class Message>(std::type_identity<Message>) {
    if constexpr (!std::is_same_v<Message, ping1d::Unknown>) {
      append_type(lua, static_cast<unsigned>(Message::id), name<Message>());
    }
  });
}

template <class Message>
concept HasLayout = requires {
  ping1d::Layout<Message>::size;
};

template <class Direction>
void append_messages(std::string& lua) {
  for_each_message<Direction>([&]<class Message>(std::type_identity<Message>) {
    if constexpr (HasLayout<Message>) {
      append_message<ping1d::Layout<Message>>(lua, name<Message>());
    }
  });
}

}  // namespace

std::string ping1d_field_tables() {
  std::string lua = table_head("ping1d") + "  commands = {\n";
  append_types<ping1d::Command>(lua);
  lua += "  },\n  reports = {\n";
  append_types<ping1d::Report>(lua);
  lua += "  },\n  messages = {\n";
  append_messages<ping1d::Command>(lua);
  append_messages<ping1d::Report>(lua);
  return lua + "  },\n}\n";
}

}  // namespace sonard::wireshark
