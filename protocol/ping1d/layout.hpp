// SPDX-License-Identifier: Apache-2.0
// Layout tables of all messages. Offsets are from the start of the frame, 8 more than in
// protocol/ping1d/README.md 2; sizes exclude the checksum at its end. The points of a profile, with their
// count, follow its table.
#pragma once

#include <tuple>

#include "protocol/ping/layout.hpp"
#include "protocol/ping1d/messages.hpp"

namespace sonard::ping1d {

/// Table of one message or of its fixed part (protocol/common/layout.hpp); without `size` if it has none.
template <class Message>
struct Layout : CommonLayout<Message> {};

/// Name of the value of a Single: that of its message without "set_", with three exceptions.
constexpr std::string_view value_name(MessageId id) {
  if (id == MessageId::continuous_start || id == MessageId::continuous_stop) {
    return "id";
  }
  if (id == MessageId::ping_enable || id == MessageId::set_ping_enable) {
    return "ping_enabled";
  }
  const std::string_view name = name_of(id);
  return name.starts_with("set_") ? name.substr(4) : name;
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

template <>
struct Layout<Distance> : WholeLayout<32> {
  static constexpr auto fields = std::tuple{
      Field{8, "distance", &Distance::distance_mm},
      Field{12, "confidence", &Distance::confidence_percent},
      Field{14, "transmit_duration", &Distance::transmit_duration_us},
      Field{16, "ping_number", &Distance::ping_number},
      Field{20, "scan_start", &Distance::scan_start_mm},
      Field{24, "scan_length", &Distance::scan_length_mm},
      Field{28, "gain_setting", &Distance::gain_setting},
  };
};
/// Up to the count of its points.
template <>
struct Layout<Profile> : Layout<Distance> {};

}  // namespace sonard::ping1d
