// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>
#include <type_traits>

#include "clients/wireshark/lua_tables.hpp"
#include "protocol/gemini/layout.hpp"

namespace sonard::wireshark {
namespace {

std::string_view name_of(gemini::MessageType type) {
  using enum gemini::MessageType;
  switch (type) {
    case status_request:
      return "status_request";
    case ping_config:
      return "ping_config";
    case flash_write:
      return "flash_write";
    case flash_read:
      return "flash_read";
    case info_block_write:
      return "info_block_write";
    case info_block_read:
      return "info_block_read";
    case serial_transmit:
      return "serial_transmit";
    case reboot:
      return "reboot";
    case test_result_request:
      return "test_result_request";
    case production_test:
      return "production_test";
    case power_on_self_test:
      return "power_on_self_test";
    case abort_production_test:
      return "abort_production_test";
    case retry_request:
      return "retry_request";
    case network_config:
      return "network_config";
    case mdio_commands:
      return "mdio_commands";
    case tx_drive_test:
      return "tx_drive_test";
    case gpo_write:
      return "gpo_write";
    case gpio_read:
      return "gpio_read";
    case diagnostic_request:
      return "diagnostic_request";
    case going_offline:
      return "going_offline";
    case status:
      return "status";
    case ping_head:
      return "ping_head";
    case ping_line:
      return "ping_line";
    case ping_tail:
      return "ping_tail";
    case flash_result:
      return "flash_result";
    case flash_readback:
      return "flash_readback";
    case velocimeter_data:
      return "velocimeter_data";
    case serial_data:
      return "serial_data";
    case acknowledge:
      return "acknowledge";
    case test_result:
      return "test_result";
    case mdio_acknowledge:
      return "mdio_acknowledge";
    case gpi_data:
      return "gpi_data";
    case diagnostic:
      return "diagnostic";
  }
  return "unknown";
}

template <class Direction>
void append_types(std::string& lua) {
  for_each_message<Direction>([&]<class Message>(std::type_identity<Message>) {
    if constexpr (!std::is_same_v<Message, gemini::Unknown>) {
      append_type(lua, static_cast<unsigned>(Message::type), name_of(Message::type));
    }
  });
}

template <class Direction>
void append_messages(std::string& lua) {
  for_each_message<Direction>([&]<class Message>(std::type_identity<Message>) {
    if constexpr (gemini::HasLayout<Message>) {
      append_message<gemini::Layout<Message>>(lua, name_of(Message::type));
    }
  });
}

}  // namespace

std::string gemini_field_tables() {
  std::string lua = table_head("gemini") + "  commands = {\n";
  append_types<gemini::Command>(lua);
  lua += "  },\n  reports = {\n";
  append_types<gemini::Report>(lua);
  lua += "  },\n  messages = {\n";
  append_messages<gemini::Command>(lua);
  append_messages<gemini::Report>(lua);
  return lua + "  },\n}\n";
}

}  // namespace sonard::wireshark
