// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>
#include <type_traits>

#include "clients/wireshark/lua_tables.hpp"
#include "protocol/micron/layout.hpp"

namespace sonard::wireshark {

template <>
struct InnerTable<micron::PortSettings> {
  using type = micron::Layout<micron::PortSettings>;
};

namespace {

std::string_view name_of(micron::MessageType type) {
  using enum micron::MessageType;
  switch (type) {
    case version_data:
      return "version_data";
    case head_data:
      return "head_data";
    case alive:
      return "alive";
    case bb_user_data:
      return "bb_user_data";
    case aux_data:
      return "aux_data";
    case reboot:
      return "reboot";
    case head_command:
      return "head_command";
    case send_version:
      return "send_version";
    case send_bb_user:
      return "send_bb_user";
    case send_data:
      return "send_data";
    case send_fpga_version:
      return "send_fpga_version";
    case fpga_version_data:
      return "fpga_version_data";
    case send_fpga_cal_data:
      return "send_fpga_cal_data";
    case fpga_cal_data:
      return "fpga_cal_data";
    case stop_alives:
      return "stop_alives";
  }
  return "unknown";
}

/// Head commands have three forms. The first has the type's name.
template <class Message>
constexpr bool has_type_of_its_own =
    !std::is_same_v<Message, micron::Unknown> && !std::is_same_v<Message, micron::GainCommand> &&
    !std::is_same_v<Message, micron::ReverseCommand>;

template <class Direction>
void append_types(std::string& lua) {
  for_each_message<Direction>([&]<class Message>(std::type_identity<Message>) {
    if constexpr (has_type_of_its_own<Message>) {
      append_type(lua, static_cast<unsigned>(Message::type), name_of(Message::type));
    }
  });
}

template <class Message>
void append_message_of(std::string& lua) {
  append_message<micron::Layout<Message>>(lua, name_of(Message::type));
}

}  // namespace

std::string micron_field_tables() {
  std::string lua = table_head("micron") + "  commands = {\n";
  append_types<micron::Command>(lua);
  lua += "  },\n  reports = {\n";
  append_types<micron::Report>(lua);
  lua += "  },\n  messages = {\n";
  append_message_of<micron::SendData>(lua);
  append_message_of<micron::HeadCommand>(lua);
  append_message<micron::Layout<micron::GainBlock>>(lua, "gain_block");
  append_message_of<micron::VersionData>(lua);
  append_message_of<micron::Alive>(lua);
  append_message_of<micron::HeadData>(lua);
  append_message_of<micron::BBUserData>(lua);
  append_message_of<micron::FpgaVersionData>(lua);
  append_message_of<micron::FpgaCalData>(lua);
  return lua + "  },\n}\n";
}

}  // namespace sonard::wireshark
