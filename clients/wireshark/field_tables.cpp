// SPDX-License-Identifier: Apache-2.0
#include "clients/wireshark/field_tables.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>

#include "protocol/gemini/layout.hpp"
#include "protocol/micron/layout.hpp"

namespace sonard::wireshark {
namespace {

// ---- One field: { offset, size, name, count }, where a count of 1 is left out

void append_field(std::string& lua, std::size_t offset, std::size_t size, const std::string& name,
                  std::size_t count = 1) {
  lua += "      { " + std::to_string(offset) + ", " + std::to_string(size) + ", \"" + name + "\"";
  if (count != 1) {
    lua += ", " + std::to_string(count);
  }
  lua += " },\n";
}

/// What a member is on the wire: `count` values of `size` bytes each.
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

template <class Table>
void append_fields(std::string& lua, std::size_t base, const std::string& prefix);

template <class Message, class Member>
void append(std::string& lua, std::size_t base, const std::string& prefix,
            const Field<Message, Member>& field) {
  const std::string name = prefix + std::string{field.name};
  if constexpr (std::is_same_v<Member, micron::PortSettings>) {
    append_fields<micron::Layout<Member>>(lua, base + field.offset, name + "_");
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

template <class Table>
void append_message(std::string& lua, std::string_view name) {
  lua += "    " + std::string{name} + " = { size = " + std::to_string(Table::size) +
         ", minimum = " + std::to_string(Table::minimum) + ", fields = {\n";
  append_fields<Table>(lua, 0, "");
  lua += "    } },\n";
}

void append_type(std::string& lua, std::uint8_t type, std::string_view name) {
  lua += "    [" + std::to_string(type) + "] = \"" + std::string{name} + "\",\n";
}

std::string table_head(std::string_view device) {
  return "-- Made by wireshark_fields from protocol/" + std::string{device} +
         "/layout.hpp; not to be edited.\n"
         "-- A field is { offset, size in bytes, name, number of values if there are several }, "
         "little-endian.\n"
         "return {\n";
}

// ---- Gemini

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

template <class... Messages>
void append_gemini_types(std::string& lua, const std::variant<Messages...>*) {
  const auto append_one = [&]<class Message>(const Message*) {
    if constexpr (!std::is_same_v<Message, gemini::Unknown>) {
      append_type(lua, static_cast<std::uint8_t>(Message::type), name_of(Message::type));
    }
  };
  (append_one(static_cast<const Messages*>(nullptr)), ...);
}

template <class... Messages>
void append_gemini_messages(std::string& lua, const std::variant<Messages...>*) {
  const auto append_one = [&]<class Message>(const Message*) {
    if constexpr (gemini::HasLayout<Message>) {
      append_message<gemini::Layout<Message>>(lua, name_of(Message::type));
    }
  };
  (append_one(static_cast<const Messages*>(nullptr)), ...);
}

// ---- Micron

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

/// Head commands have three forms, of which the first stands for the type.
template <class Message>
constexpr bool has_type_of_its_own =
    !std::is_same_v<Message, micron::Unknown> && !std::is_same_v<Message, micron::GainCommand> &&
    !std::is_same_v<Message, micron::ReverseCommand>;

template <class... Messages>
void append_micron_types(std::string& lua, const std::variant<Messages...>*) {
  const auto append_one = [&]<class Message>(const Message*) {
    if constexpr (has_type_of_its_own<Message>) {
      append_type(lua, static_cast<std::uint8_t>(Message::type), name_of(Message::type));
    }
  };
  (append_one(static_cast<const Messages*>(nullptr)), ...);
}

template <class Message>
void append_micron_message(std::string& lua) {
  append_message<micron::Layout<Message>>(lua, name_of(Message::type));
}

}  // namespace

std::string gemini_field_tables() {
  std::string lua = table_head("gemini") + "  commands = {\n";
  append_gemini_types(lua, static_cast<const gemini::Command*>(nullptr));
  lua += "  },\n  reports = {\n";
  append_gemini_types(lua, static_cast<const gemini::Report*>(nullptr));
  lua += "  },\n  messages = {\n";
  append_gemini_messages(lua, static_cast<const gemini::Command*>(nullptr));
  append_gemini_messages(lua, static_cast<const gemini::Report*>(nullptr));
  return lua + "  },\n}\n";
}

std::string micron_field_tables() {
  std::string lua = table_head("micron") + "  commands = {\n";
  append_micron_types(lua, static_cast<const micron::Command*>(nullptr));
  lua += "  },\n  reports = {\n";
  append_micron_types(lua, static_cast<const micron::Report*>(nullptr));
  lua += "  },\n  messages = {\n";
  append_micron_message<micron::SendData>(lua);
  append_micron_message<micron::HeadCommand>(lua);
  append_message<micron::Layout<micron::GainBlock>>(lua, "gain_block");
  append_micron_message<micron::VersionData>(lua);
  append_micron_message<micron::Alive>(lua);
  append_micron_message<micron::HeadData>(lua);
  append_micron_message<micron::BBUserData>(lua);
  append_micron_message<micron::FpgaVersionData>(lua);
  append_micron_message<micron::FpgaCalData>(lua);
  return lua + "  },\n}\n";
}

}  // namespace sonard::wireshark
