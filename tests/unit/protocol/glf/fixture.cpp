// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/protocol/glf/fixture.hpp"

#include <algorithm>
#include <sstream>

#include "protocol/glf/deflate.hpp"

namespace sonard::glf::testing {

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  std::istringstream words{text};
  for (std::string word; words >> word;) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(word, nullptr, 16)));
  }
  return bytes;
}

ImageRecord small_image() {
  return {.origin = {.time_s = 1000.5, .device_id = 1194, .node_id = 101},
          .lines = 2,
          .beams = 3,
          .pixels = {10, 20, 30, 40, 50, 255},
          .bearings_rad = {1.0, 0.0, -1.0},
          .state_flags = 0x01020304,
          .modulation_frequency_hz = 18750,
          .aperture_deg = 65.0F,
          .transmit_time_s = 1000.5,
          .ping_flags = ping_flag_bits::high_frequency | ping_flag_bits::manual_sound_speed,
          .sound_speed_mps = 1500.0F,
          .gain_percent = 53,
          .chirp = true,
          .sonar_type = SonarType::mk2_imager,
          .platform = Platform::gemini_1200ik};
}

ImageRecord patterned_image(int number) {
  ImageRecord image = small_image();
  image.origin.time_s = 1000.0 + 0.1 * number;
  image.lines = 50;
  image.beams = 64;
  image.pixels.clear();
  for (unsigned line = 0; line < image.lines; ++line) {
    for (unsigned beam = 0; beam < image.beams; ++beam) {
      image.pixels.push_back(
          static_cast<std::uint8_t>(7U * static_cast<unsigned>(number) + 3 * line + 5 * beam));
    }
  }
  image.bearings_rad.clear();
  for (unsigned beam = 0; beam < image.beams; ++beam) {
    image.bearings_rad.push_back(1.0 - beam / 32.0);
  }
  return image;
}

StatusRecord small_status() {
  return {.origin = {.time_s = 2000.25, .device_id = 513, .node_id = 102},
          .version = 1,
          .bf_firmware_version = 0x0203,
          .da_version = 0x0405,
          .flags = 0x0607,
          .device_id = 514,
          .selected_transducer = 1,
          .fpga_board_c = 20.5,
          .hsc_board_c = 21.5,
          .da_fpga_c = 22.5,
          .transducer_c = 23.5,
          .psu_c = 24.5,
          .die_c = 25.5,
          .tx_c = 26.5,
          .afe_c = {30.5, 31.5, 32.5, 33.5, 34.5, 35.5, 36.5, 37.5},
          .link_type = 0x3201,
          .uplink_mbps = 94.5,
          .downlink_mbps = 95.5,
          .link_quality_percent = 99,
          .packet_count = 1001,
          .receive_error_count = 1002,
          .resent_count = 1003,
          .dropped_count = 1004,
          .unknown_count = 1005,
          .lost_line_count = 1006,
          .general_count = 1007,
          .alternate_ip = 0x0A3D1301,
          .surface_ip = 0x0A3D1302,
          .subnet_mask = 0x00FFFFFE,
          .mac = {0x1122, 0x3344, 0x5566},
          .bf_boot_status = 0x00001003,
          .da_boot_status = 0x00001004,
          .fpga_time_us = 0x0102030405060708,
          .dip_switch = 0x0A0B,
          .shutdown_status = 4,
          .network_adaptor_found = true};
}

Bytes joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

Bytes small_dat() {
  return joined({encode(patterned_image(1)),
                 encode(small_image()),
                 encode(small_status()),
                 encode(patterned_image(2)),
                 {0xDE, 0xDE}});
}

Bytes packed(const Bytes& dat, const std::string& config_xml) {
  Crc32 crc;
  crc.add(dat);
  const Packer packer{"2026-11-20-142233",
                      config_xml,
                      {.size = dat.size(), .crc = crc.value()},
                      {.year = 2026, .month = 11, .day = 20, .hour = 14, .minute = 22, .second = 33}};
  Bytes archive = packer.head();
  for (std::size_t begin = 0; begin < dat.size(); begin += pack_block_size) {
    const auto block = std::span{dat}.subspan(begin, std::min(pack_block_size, dat.size() - begin));
    std::ranges::copy(Packer::block_header(block.size()), std::back_inserter(archive));
    std::ranges::copy(block, std::back_inserter(archive));
  }
  std::ranges::copy(packer.tail(), std::back_inserter(archive));
  return archive;
}

}  // namespace sonard::glf::testing
