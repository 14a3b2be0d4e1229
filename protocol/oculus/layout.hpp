// SPDX-License-Identifier: Apache-2.0
// Layout tables of all messages, used by the codec for reading and writing. Offsets are from the start of the
// message. Source: protocol/oculus/README.md. Bearings and image follow the table of a result; codec.cpp
// handles them.
#pragma once

#include <tuple>

#include "protocol/common/layout.hpp"
#include "protocol/oculus/messages.hpp"

namespace sonard::oculus {

struct HeaderLayout : WholeLayout<header_size> {
  static constexpr auto fields = std::tuple{
      Field{0, "oculusId", &Header::magic},          Field{2, "srcDeviceId", &Header::source},
      Field{4, "dstDeviceId", &Header::destination}, Field{6, "msgId", &Header::id},
      Field{8, "msgVersion", &Header::version},      Field{10, "payloadSize", &Header::payload_size},
      Field{14, "partNumber", &Header::part_number},
  };
};

struct FireLayout : WholeLayout<fire_v1_size> {
  static constexpr auto fields = std::tuple{
      Field{16, "masterMode", &Fire::master_mode},
      Field{17, "pingRate", &Fire::ping_rate},
      Field{18, "networkSpeed", &Fire::network_speed},
      Field{19, "gammaCorrection", &Fire::gamma},
      Field{20, "flags", &Fire::flags},
      Field{21, "range", &Fire::range},
      Field{29, "gainPercent", &Fire::gain_percent},
      Field{37, "speedOfSound", &Fire::sound_speed_mps},
      Field{45, "salinity", &Fire::salinity_ppt},
  };
};

struct FireExtensionLayout : WholeLayout<fire_v2_size> {
  static constexpr auto fields = std::tuple{
      Field{53, "extFlags", &FireExtension::flags},
      Field{57, "reserved", &FireExtension::reserved},
  };
};

struct ResultV1Layout : WholeLayout<result_v1_size> {
  static constexpr auto fields = std::tuple{
      Field{53, "pingId", &PingResult::ping_id},
      Field{57, "status", &PingResult::status},
      Field{61, "frequency", &PingResult::frequency_hz},
      Field{69, "temperature", &PingResult::temperature_c},
      Field{77, "pressure", &PingResult::pressure_bar},
      Field{85, "speedOfSoundUsed", &PingResult::sound_speed_mps},
      Field{93, "pingStartTime", &PingResult::start_time_ns},
      Field{97, "dataSize", &PingResult::data_size},
      Field{98, "rangeResolution", &PingResult::range_resolution_m},
      Field{106, "nRanges", &PingResult::ranges},
      Field{108, "nBeams", &PingResult::beams},
      Field{110, "imageOffset", &PingResult::image_offset},
      Field{114, "imageSize", &PingResult::image_size},
      Field{118, "messageSize", &PingResult::message_size},
  };
};

struct ResultV2Layout : WholeLayout<result_v2_size> {
  static constexpr auto fields = std::tuple{
      Field{89, "pingId", &PingResult::ping_id},
      Field{93, "status", &PingResult::status},
      Field{97, "frequency", &PingResult::frequency_hz},
      Field{105, "temperature", &PingResult::temperature_c},
      Field{113, "pressure", &PingResult::pressure_bar},
      Field{121, "heading", &PingResult::heading_deg},
      Field{129, "pitch", &PingResult::pitch_deg},
      Field{137, "roll", &PingResult::roll_deg},
      Field{145, "speedOfSoundUsed", &PingResult::sound_speed_mps},
      Field{153, "pingStartTime", &PingResult::start_time_s},
      Field{161, "dataSize", &PingResult::data_size},
      Field{162, "rangeResolution", &PingResult::range_resolution_m},
      Field{170, "nRanges", &PingResult::ranges},
      Field{172, "nBeams", &PingResult::beams},
      Spare<16>{174},
      Field{190, "imageOffset", &PingResult::image_offset},
      Field{194, "imageSize", &PingResult::image_size},
      Field{198, "messageSize", &PingResult::message_size},
  };
};

struct UserConfigLayout : WholeLayout<user_config_size> {
  static constexpr auto fields = std::tuple{
      Field{16, "ipAddr", &UserConfig::address},
      Field{20, "ipMask", &UserConfig::netmask},
      Field{24, "dhcpEnable", &UserConfig::dhcp},
  };
};

struct StatusLayout : WholeLayout<status_size> {
  static constexpr auto fields = std::tuple{
      Field{16, "deviceId", &Status::device_id},
      Field{20, "deviceType", &Status::device_type},
      Field{22, "partNumber", &Status::part_number},
      Field{24, "status", &Status::status},
      Field{28, "firmware", &Status::firmware},
      Field{52, "ipAddr", &Status::address},
      Field{56, "ipMask", &Status::netmask},
      Field{60, "connectedIpAddr", &Status::client},
      Field{64, "mac", &Status::mac},
      Field{70, "temperature", &Status::temperatures_c},
      Field{134, "pressure", &Status::pressure_bar},
  };
};

static_assert(layout_is_contiguous<HeaderLayout>(0));
static_assert(layout_is_contiguous<FireLayout>(header_size));
static_assert(layout_is_contiguous<FireExtensionLayout>(fire_v1_size));
static_assert(layout_is_contiguous<ResultV1Layout>(fire_v1_size));
static_assert(layout_is_contiguous<ResultV2Layout>(fire_v2_size));
static_assert(layout_is_contiguous<UserConfigLayout>(header_size));
static_assert(layout_is_contiguous<StatusLayout>(header_size));

}  // namespace sonard::oculus
