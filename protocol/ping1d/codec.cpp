// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/codec.hpp"

#include <algorithm>

#include "protocol/ping/codec.hpp"
#include "protocol/ping1d/layout.hpp"

namespace sonard::ping1d {

bool Profile::operator==(const Profile& other) const {
  return measurement<Distance>(*this) == measurement<Distance>(other) && std::ranges::equal(data, other.data);
}

namespace {

template <class... Messages>
consteval bool are_contiguous() {
  return (layout_is_contiguous<Layout<Messages>>(frame_header_size) && ...);
}
static_assert(are_contiguous<SetDeviceId, SetRange, SetSpeedOfSound, SetPingInterval, FirmwareVersion,
                             GeneralInfo, DistanceSimple, Distance, Profile>());

}  // namespace

std::string_view name_of(MessageId id) {
  using enum MessageId;
  switch (id) {
    case set_device_id:
      return "set_device_id";
    case set_range:
      return "set_range";
    case set_speed_of_sound:
      return "set_speed_of_sound";
    case set_mode_auto:
      return "set_mode_auto";
    case set_ping_interval:
      return "set_ping_interval";
    case set_gain_setting:
      return "set_gain_setting";
    case set_ping_enable:
      return "set_ping_enable";
    case goto_bootloader:
      return "goto_bootloader";
    case firmware_version:
      return "firmware_version";
    case range:
      return "range";
    case general_info:
      return "general_info";
    case distance_simple:
      return "distance_simple";
    case distance:
      return "distance";
    case profile:
      return "profile";
    case continuous_start:
      return "continuous_start";
    case continuous_stop:
      return "continuous_stop";
    case ping_enable:
      return "ping_enable";
    default:
      return value_name(id);
  }
}

bool can_be_requested(std::uint16_t id) {
  if (id == static_cast<std::uint16_t>(CommonId::device_information) ||
      id == static_cast<std::uint16_t>(CommonId::protocol_version)) {
    return true;
  }
  const auto in = [id](MessageId first, MessageId last) {
    return id >= static_cast<std::uint16_t>(first) && id <= static_cast<std::uint16_t>(last);
  };
  return in(MessageId::firmware_version, MessageId::transmit_duration) ||
         in(MessageId::general_info, MessageId::ping_enable) || in(MessageId::profile, MessageId::profile);
}

Result<Command, WireError> decode_command(std::span<const std::uint8_t> frame) {
  if (frame.size() == frame_overhead && can_be_requested(frame_header(frame).message_id)) {
    return Command{GeneralRequest{frame_header(frame).message_id}};
  }
  return decode_frame<Layout, Command>(frame, true);
}

Result<Report, WireError> decode_report(std::span<const std::uint8_t> frame) {
  return decode_frame<Layout, Report>(frame, false);
}

std::vector<std::uint8_t> encode(const Command& command, std::uint8_t source, std::uint8_t destination) {
  return encode_frame<Layout>(command, source, destination);
}

std::vector<std::uint8_t> encode(const Report& report, std::uint8_t source, std::uint8_t destination) {
  return encode_frame<Layout>(report, source, destination);
}

std::uint16_t id_of(const Command& command) {
  return id_in(command);
}
std::uint16_t id_of(const Report& report) {
  return id_in(report);
}

}  // namespace sonard::ping1d
