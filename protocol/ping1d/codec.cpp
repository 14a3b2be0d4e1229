// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/codec.hpp"

#include <algorithm>

#include "protocol/ping/codec.hpp"
#include "protocol/ping1d/layout.hpp"

namespace sonard::ping1d {

bool Profile::operator==(const Profile& other) const {
  return measured() == other.measured() && std::ranges::equal(data, other.data);
}

namespace {

template <class... Messages>
consteval bool are_contiguous() {
  return (layout_is_contiguous<Layout<Messages>>(frame_header_size) && ...);
}
static_assert(are_contiguous<SetDeviceId, SetRange, SetSpeedOfSound, SetPingInterval, FirmwareVersion,
                             GeneralInfo, DistanceSimple, Distance, Profile>());

}  // namespace

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
