// SPDX-License-Identifier: Apache-2.0
// Layout tables of the common messages. Offsets are from the start of the frame, 8 more than in
// protocol/ping360/README.md 2; sizes exclude the checksum at its end. Texts follow the table of their
// message.
#pragma once

#include <tuple>

#include "protocol/common/layout.hpp"
#include "protocol/ping/messages.hpp"

namespace sonard::ping {

/// Table of one message or of its fixed part (protocol/common/layout.hpp); empty for messages that are not
/// common, or have only text.
template <class Message>
struct CommonLayout {};

template <>
struct CommonLayout<GeneralRequest> : WholeLayout<10> {
  static constexpr auto fields = std::tuple{Field{8, "requested_id", &GeneralRequest::requested_id}};
};

template <>
struct CommonLayout<SetCommonDeviceId> : WholeLayout<9> {
  static constexpr auto fields = std::tuple{Field{8, "device_id", &SetCommonDeviceId::device_id}};
};

template <>
struct CommonLayout<Ack> : WholeLayout<10> {
  static constexpr auto fields = std::tuple{Field{8, "acked_id", &Ack::acked_id}};
};

/// Without the text, which follows.
template <>
struct CommonLayout<Nack> : WholeLayout<10> {
  static constexpr auto fields = std::tuple{Field{8, "nacked_id", &Nack::nacked_id}};
};

template <>
struct CommonLayout<DeviceInformation> : WholeLayout<14> {
  static constexpr auto fields = std::tuple{
      Field{8, "device_type", &DeviceInformation::device_type},
      Field{9, "device_revision", &DeviceInformation::device_revision},
      Field{10, "firmware_version_major", &DeviceInformation::firmware_major},
      Field{11, "firmware_version_minor", &DeviceInformation::firmware_minor},
      Field{12, "firmware_version_patch", &DeviceInformation::firmware_patch},
      Spare<1>{13},
  };
};

template <>
struct CommonLayout<ProtocolVersion> : WholeLayout<12> {
  static constexpr auto fields = std::tuple{
      Field{8, "version_major", &ProtocolVersion::major},
      Field{9, "version_minor", &ProtocolVersion::minor},
      Field{10, "version_patch", &ProtocolVersion::patch},
      Spare<1>{11},
  };
};

}  // namespace sonard::ping
