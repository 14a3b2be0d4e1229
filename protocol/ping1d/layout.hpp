// SPDX-License-Identifier: Apache-2.0
// Layout tables of all messages. Offsets are from the start of the frame, 8 more than in
// docs/protocols/ping1d.md 2; sizes exclude the checksum at its end. The points of a profile, with their
// count, follow its table.
#pragma once

#include <tuple>

#include "protocol/ping/layout.hpp"
#include "protocol/ping1d/messages.hpp"

namespace sonard::ping1d {

/// Table of one message or of its fixed part (protocol/common/layout.hpp); without `size` if it has none.
template <class Message>
struct Layout : CommonLayout<Message> {};

/// Name of the value of a Single.
constexpr std::string_view value_name(MessageId id) {
  using enum MessageId;
  switch (id) {
    case set_device_id:
    case device_id:
      return "device_id";
    case set_speed_of_sound:
    case speed_of_sound:
      return "speed_of_sound";
    case set_mode_auto:
    case mode_auto:
      return "mode_auto";
    case set_ping_interval:
    case ping_interval:
      return "ping_interval";
    case set_gain_setting:
    case gain_setting:
      return "gain_setting";
    case set_ping_enable:
    case ping_enable:
      return "ping_enabled";
    case voltage_5:
      return "voltage_5";
    case transmit_duration:
      return "transmit_duration";
    case processor_temperature:
      return "processor_temperature";
    case pcb_temperature:
      return "pcb_temperature";
    default:
      return "id";
  }
}

template <MessageId Id, class Value>
struct Layout<Single<Id, Value>> : WholeLayout<frame_header_size + sizeof(Value)> {
  static constexpr auto fields = std::tuple{Field{8, value_name(Id), &Single<Id, Value>::value}};
};

template <MessageId Id>
struct Layout<RangeMessage<Id>> : WholeLayout<16> {
  static constexpr auto fields = std::tuple{Field{8, "scan_start", &RangeMessage<Id>::start_mm},
                                            Field{12, "scan_length", &RangeMessage<Id>::length_mm}};
};

template <>
struct Layout<FirmwareVersion> : WholeLayout<14> {
  static constexpr auto fields = std::tuple{
      Field{8, "device_type", &FirmwareVersion::device_type},
      Field{9, "device_model", &FirmwareVersion::device_model},
      Field{10, "firmware_version_major", &FirmwareVersion::major},
      Field{12, "firmware_version_minor", &FirmwareVersion::minor},
  };
};

template <>
struct Layout<GeneralInfo> : WholeLayout<18> {
  static constexpr auto fields = std::tuple{
      Field{8, "firmware_version_major", &GeneralInfo::firmware_major},
      Field{10, "firmware_version_minor", &GeneralInfo::firmware_minor},
      Field{12, "voltage_5", &GeneralInfo::voltage_mv},
      Field{14, "ping_interval", &GeneralInfo::ping_interval_ms},
      Field{16, "gain_setting", &GeneralInfo::gain_setting},
      Field{17, "mode_auto", &GeneralInfo::mode_auto},
  };
};

template <>
struct Layout<DistanceSimple> : WholeLayout<13> {
  static constexpr auto fields = std::tuple{Field{8, "distance", &DistanceSimple::distance_mm},
                                            Field{12, "confidence", &DistanceSimple::confidence_percent}};
};

template <class Message>
struct MeasurementLayout : WholeLayout<32> {
  static constexpr auto fields = std::tuple{
      Field{8, "distance", &Message::distance_mm},
      Field{12, "confidence", &Message::confidence_percent},
      Field{14, "transmit_duration", &Message::transmit_duration_us},
      Field{16, "ping_number", &Message::ping_number},
      Field{20, "scan_start", &Message::scan_start_mm},
      Field{24, "scan_length", &Message::scan_length_mm},
      Field{28, "gain_setting", &Message::gain_setting},
  };
};
template <>
struct Layout<Distance> : MeasurementLayout<Distance> {};
/// Up to the count of its points.
template <>
struct Layout<Profile> : MeasurementLayout<Profile> {};

}  // namespace sonard::ping1d
