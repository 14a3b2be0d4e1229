#include "protocol/gemini/messages.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::gemini {

std::string_view to_string(MessageType type) {
  switch (type) {
    case MessageType::status_request:
      return "status_request";
    case MessageType::ping_config:
      return "ping_config";
    case MessageType::flash_write:
      return "flash_write";
    case MessageType::flash_read:
      return "flash_read";
    case MessageType::info_block_write:
      return "info_block_write";
    case MessageType::info_block_read:
      return "info_block_read";
    case MessageType::serial_transmit:
      return "serial_transmit";
    case MessageType::reboot:
      return "reboot";
    case MessageType::test_result_request:
      return "test_result_request";
    case MessageType::production_test:
      return "production_test";
    case MessageType::power_on_self_test:
      return "power_on_self_test";
    case MessageType::abort_production_test:
      return "abort_production_test";
    case MessageType::retry_request:
      return "retry_request";
    case MessageType::network_config:
      return "network_config";
    case MessageType::mdio_commands:
      return "mdio_commands";
    case MessageType::tx_drive_test:
      return "tx_drive_test";
    case MessageType::gpo_write:
      return "gpo_write";
    case MessageType::gpio_read:
      return "gpio_read";
    case MessageType::diagnostic_request:
      return "diagnostic_request";
    case MessageType::going_offline:
      return "going_offline";
    case MessageType::status:
      return "status";
    case MessageType::ping_head:
      return "ping_head";
    case MessageType::ping_line:
      return "ping_line";
    case MessageType::ping_tail:
      return "ping_tail";
    case MessageType::flash_result:
      return "flash_result";
    case MessageType::flash_readback:
      return "flash_readback";
    case MessageType::velocimeter_data:
      return "velocimeter_data";
    case MessageType::serial_data:
      return "serial_data";
    case MessageType::acknowledge:
      return "acknowledge";
    case MessageType::test_result:
      return "test_result";
    case MessageType::mdio_acknowledge:
      return "mdio_acknowledge";
    case MessageType::gpi_data:
      return "gpi_data";
    case MessageType::diagnostic:
      return "diagnostic";
  }
  return "unknown";
}

int compression_log2(std::uint16_t range_compression) {
  const int bits = range_compression & 7;
  return bits <= 4 ? bits : 0;
}

bool PingConfig::eight_bit() const {
  return (ext_mode & ext_bits::eight_bit) != 0 && data_type() == DataType::beam_magnitude;
}

std::uint8_t PingConfig::rle_threshold_applied() const {
  if (rle_threshold == 0 || !eight_bit()) {
    return 0;
  }
  return static_cast<std::uint8_t>(std::clamp<std::uint16_t>(rle_threshold, 3, 255));
}

int PingHead::line_count() const {
  return std::max(0, int{end_range} - int{start_range}) >> compression_log2();
}

bool PingLine::operator==(const PingLine& other) const {
  return header == other.header && gain == other.gain && ping_id == other.ping_id &&
         line_id == other.line_id && scale == other.scale && line_info == other.line_info &&
         std::ranges::equal(data, other.data);
}

std::uint16_t temperature_code(double celsius) {
  const double clamped = std::clamp(celsius, -128.0, 127.75);
  const auto quarters = static_cast<std::int32_t>(std::lround(clamped * 4.0));
  return static_cast<std::uint16_t>(0x8000U | (static_cast<std::uint32_t>(quarters) & 0x3FFU));
}

std::optional<double> temperature_celsius(std::uint16_t code) {
  if ((code & 0x8000) == 0) {
    return std::nullopt;
  }
  const int magnitude = code & 0x3FF;
  return (magnitude < 0x200 ? magnitude : magnitude - 0x400) * 0.25;
}

std::uint16_t die_temperature_code(double celsius) {
  const double code = std::round((celsius + 273.15) * 1024.0 / 503.975);
  return static_cast<std::uint16_t>(std::clamp(code, 0.0, 1023.0));
}

double die_temperature_celsius(std::uint16_t code) {
  return code * 503.975 / 1024.0 - 273.15;
}

}  // namespace sonard::gemini
