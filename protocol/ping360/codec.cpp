// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/codec.hpp"

#include <algorithm>
#include <tuple>

#include "protocol/ping/codec.hpp"
#include "protocol/ping360/layout.hpp"

namespace sonard::ping360 {

bool DeviceData::operator==(const DeviceData& other) const {
  const auto rest = [](const DeviceData& it) {
    return std::tie(it.mode, it.gain_setting, it.angle, it.transmit_duration_us, it.sample_period,
                    it.transmit_frequency_khz, it.number_of_samples);
  };
  return rest(*this) == rest(other) && std::ranges::equal(data, other.data);
}

bool AutoDeviceData::operator==(const AutoDeviceData& other) const {
  const auto rest = [](const AutoDeviceData& it) {
    return std::tie(it.mode, it.gain_setting, it.angle, it.transmit_duration_us, it.sample_period,
                    it.transmit_frequency_khz, it.start_angle, it.stop_angle, it.num_steps, it.delay_ms,
                    it.number_of_samples);
  };
  return rest(*this) == rest(other) && std::ranges::equal(data, other.data);
}

namespace {

template <class... Messages>
consteval bool are_contiguous() {
  return (layout_is_contiguous<Layout<Messages>>(frame_header_size) && ...);
}
static_assert(are_contiguous<GeneralRequest, SetCommonDeviceId, SetDeviceId, Reset, Transducer, AutoTransmit,
                             Ack, Nack, DeviceInformation, ProtocolVersion, DeviceData, AutoDeviceData>());

/// True if an empty message with this id is a request for that message (2.1).
bool is_older_request(std::uint16_t id) {
  return id == static_cast<std::uint16_t>(MessageId::device_information) ||
         id == static_cast<std::uint16_t>(MessageId::protocol_version) ||
         id == static_cast<std::uint16_t>(MessageId::device_data);
}

}  // namespace

Result<Command, WireError> decode_command(std::span<const std::uint8_t> frame) {
  if (frame.size() == frame_overhead && is_older_request(frame_header(frame).message_id)) {
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

}  // namespace sonard::ping360
