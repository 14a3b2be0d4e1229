// SPDX-License-Identifier: Apache-2.0
// Layout tables of all records, used for reading and writing. Source: protocol/glf/README.md 1.3 to 1.5.
// codec.cpp and headers.cpp handle the parts that depend on the record itself (pixels, bearings, the field
// that other versions of images lack).
#pragma once

#include <tuple>

#include "protocol/common/layout.hpp"
#include "protocol/glf/headers.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::glf {

/// Table of one part of a record (protocol/common/layout.hpp). Offsets are from the start of the part.
template <class Part>
struct Layout;

template <>
struct Layout<CiHeader> : WholeLayout<ci_header_size> {
  static constexpr auto fields = std::tuple{
      Field{0, "id", &CiHeader::id},
      Field{1, "version", &CiHeader::version},
      Field{2, "length", &CiHeader::length},
      Field{6, "time", &CiHeader::time_s},
      Field{14, "data_type", &CiHeader::type},
      Field{15, "device_id", &CiHeader::device_id},
      Field{17, "node_id", &CiHeader::node_id},
      Spare<2>{19},
  };
};

/// The fields before the first difference between versions.
template <>
struct Layout<ImageHeader> : WholeLayout<24> {
  static constexpr auto fields = std::tuple{
      Field{0, "record_type", &ImageHeader::record_type},
      Field{2, "record_tag", &ImageHeader::tag},
      Field{4, "image_version", &ImageHeader::version},
      Field{6, "start_range", &ImageHeader::first_line},
      Field{10, "end_range", &ImageHeader::end_line},
      Field{14, "range_compression", &ImageHeader::range_compression},
      Field{16, "start_bearing", &ImageHeader::first_beam},
      Field{20, "end_bearing", &ImageHeader::end_beam},
  };
};

/// The fields after the bearings, before the byte for the acoustic zoom.
template <>
struct Layout<ImageRecord> : WholeLayout<31> {
  static constexpr auto fields = std::tuple{
      Field{0, "state_flags", &ImageRecord::state_flags},
      Field{4, "modulation_frequency", &ImageRecord::modulation_frequency_hz},
      Field{8, "aperture", &ImageRecord::aperture_deg},
      Field{12, "transmit_time", &ImageRecord::transmit_time_s},
      Field{20, "ping_flags", &ImageRecord::ping_flags},
      Field{22, "sound_speed", &ImageRecord::sound_speed_mps},
      Field{26, "gain", &ImageRecord::gain_percent},
      Field{28, "chirp", &ImageRecord::chirp},
      Field{29, "sonar_type", &ImageRecord::sonar_type},
      Field{30, "platform", &ImageRecord::platform},
  };
};

template <>
struct Layout<StatusRecord> : WholeLayout<status_body_size> {
  static constexpr auto fields = std::tuple{
      Field{0, "status_version", &StatusRecord::version},
      Field{2, "bf_firmware_version", &StatusRecord::bf_firmware_version},
      Field{4, "da_version", &StatusRecord::da_version},
      Field{6, "flags", &StatusRecord::flags},
      Field{8, "status_device_id", &StatusRecord::device_id},
      Field{10, "selected_transducer", &StatusRecord::selected_transducer},
      Field{11, "fpga_board_temperature", &StatusRecord::fpga_board_c},
      Field{19, "hsc_board_temperature", &StatusRecord::hsc_board_c},
      Field{27, "da_fpga_temperature", &StatusRecord::da_fpga_c},
      Field{35, "transducer_temperature", &StatusRecord::transducer_c},
      Field{43, "psu_temperature", &StatusRecord::psu_c},
      Field{51, "die_temperature", &StatusRecord::die_c},
      Field{59, "tx_temperature", &StatusRecord::tx_c},
      Field{67, "afe_temperatures", &StatusRecord::afe_c},
      Field{131, "link_type", &StatusRecord::link_type},
      Field{133, "uplink", &StatusRecord::uplink_mbps},
      Field{141, "downlink", &StatusRecord::downlink_mbps},
      Field{149, "link_quality", &StatusRecord::link_quality_percent},
      Field{151, "packet_count", &StatusRecord::packet_count},
      Field{155, "receive_error_count", &StatusRecord::receive_error_count},
      Field{159, "resent_count", &StatusRecord::resent_count},
      Field{163, "dropped_count", &StatusRecord::dropped_count},
      Field{167, "unknown_count", &StatusRecord::unknown_count},
      Field{171, "lost_line_count", &StatusRecord::lost_line_count},
      Field{175, "general_count", &StatusRecord::general_count},
      Field{179, "alternate_ip", &StatusRecord::alternate_ip},
      Field{183, "surface_ip", &StatusRecord::surface_ip},
      Field{187, "subnet_mask", &StatusRecord::subnet_mask},
      Field{191, "mac", &StatusRecord::mac},
      Field{197, "bf_boot_status", &StatusRecord::bf_boot_status},
      Field{201, "da_boot_status", &StatusRecord::da_boot_status},
      Field{205, "fpga_time", &StatusRecord::fpga_time_us},
      Field{213, "dip_switch", &StatusRecord::dip_switch},
      Field{215, "shutdown_status", &StatusRecord::shutdown_status},
      Field{217, "network_adaptor_found", &StatusRecord::network_adaptor_found},
  };
};

}  // namespace sonard::glf
