// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/glf_status.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace sonard::gemini {
namespace {

// Bits of glf::StatusRecord::link_type (protocol/glf/README.md 1.5).
constexpr std::uint16_t link_vdsl = 0x0001;
constexpr std::uint16_t link_100_mbps = 0x0100;
constexpr std::uint16_t link_negotiated = 0x1000;

std::uint16_t link_type(std::uint16_t link) {
  if ((link & link_bits::vdsl) != 0) {
    return link_vdsl | link_negotiated;
  }
  const bool fast = (link & link_bits::ethernet_100) != 0;
  return static_cast<std::uint16_t>((fast ? link_100_mbps : 0U) | link_negotiated);
}

std::array<std::uint16_t, 3> mac_words(const MacAddress& mac) {
  std::array<std::uint16_t, 3> words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    words.at(i) = static_cast<std::uint16_t>(mac.octets.at(2 * i) << 8 | mac.octets.at(2 * i + 1));
  }
  return words;
}

double celsius(std::uint16_t code) {
  return temperature_celsius(code).value_or(0.0);  // 0 for a missing sensor
}

}  // namespace

glf::StatusRecord glf_status(const Status& status) {
  glf::StatusRecord record;
  record.bf_firmware_version = status.firmware_version;
  record.device_id = status.sonar_id;
  record.selected_transducer = static_cast<std::uint8_t>(status.transducer);
  record.psu_c = celsius(status.psu2_temperature);
  record.die_c = die_temperature_celsius(status.die_temperature);
  record.tx_c = celsius(status.tx1_temperature);
  record.afe_c = {celsius(status.vga1a_temperature), celsius(status.vga1b_temperature),
                  celsius(status.vga2a_temperature), celsius(status.vga2b_temperature)};
  record.link_type = link_type(status.link_type);
  record.alternate_ip = status.alternate_ip;
  record.surface_ip = status.surface_ip;
  record.subnet_mask = status.subnet_mask;
  record.mac = mac_words(status.mac);
  record.bf_boot_status = status.boot_status;
  record.fpga_time_us = status.clock_us;
  record.dip_switch = status.dip_switches;
  record.shutdown_status = status.shutdown_status;
  return record;
}

}  // namespace sonard::gemini
