// SPDX-License-Identifier: Apache-2.0
// Common form of the two messages that contain a ping.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

struct PingForm {
  DeviceData settings;               ///< settings and angle, without data
  std::optional<AutoTransmit> scan;  ///< scan of the ping; nullopt: a single ping

  bool operator==(const PingForm&) const = default;
};

/// The form of the ping of a command.
PingForm form_of(const Transducer& command);
/// The form of the ping at one angle of a scan.
/// @param command command that began the scan
/// @param angle angle of the ping, gradians, 0..399
PingForm form_of(const AutoTransmit& command, int angle);
/// The form of a received ping; nullopt for other messages.
std::optional<PingForm> form_of(const Report& report);
/// The message for a ping of this form. It views `data`.
Report message_of(const PingForm& form, std::span<const std::uint8_t> data);

}  // namespace sonard::ping360
