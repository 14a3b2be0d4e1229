// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>
#include <type_traits>

#include "clients/wireshark/lua_tables.hpp"
#include "protocol/ping360/layout.hpp"

namespace sonard::wireshark {
namespace {

std::string_view name_of(ping360::MessageId id) {
  using enum ping360::MessageId;
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
    case set_device_id:
      return "set_device_id";
    case device_data:
      return "device_data";
    case auto_device_data:
      return "auto_device_data";
    case reset:
      return "reset";
    case transducer:
      return "transducer";
    case auto_transmit:
      return "auto_transmit";
    case motor_off:
      return "motor_off";
  }
  return "unknown";
}

template <class Message>
std::string_view name_of() {
  return name_of(ping360::MessageId{static_cast<std::uint16_t>(Message::id)});
}

template <class Direction>
void append_types(std::string& lua) {
  for_each_message<Direction>([&]<class Message>(std::type_identity<Message>) {
    if constexpr (!std::is_same_v<Message, ping360::Unknown>) {
      append_type(lua, static_cast<unsigned>(Message::id), name_of<Message>());
    }
  });
}

template <class Message>
concept HasLayout = requires {
  ping360::Layout<Message>::size;
};

/// Appends messages with fields. @tparam Besides a message that the other direction has appended already
template <class Direction, class Besides = void>
void append_messages(std::string& lua) {
  for_each_message<Direction>([&]<class Message>(std::type_identity<Message>) {
    if constexpr (HasLayout<Message> && !std::is_same_v<Message, Besides>) {
      append_message<ping360::Layout<Message>>(lua, name_of<Message>());
    }
  });
}

}  // namespace

std::string ping360_field_tables() {
  std::string lua = table_head("ping360") + "  commands = {\n";
  append_types<ping360::Command>(lua);
  lua += "  },\n  reports = {\n";
  append_types<ping360::Report>(lua);
  lua += "  },\n  messages = {\n";
  append_messages<ping360::Command>(lua);
  append_messages<ping360::Report, ping360::SetDeviceId>(lua);
  return lua + "  },\n}\n";
}

}  // namespace sonard::wireshark
