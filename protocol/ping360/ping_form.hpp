// SPDX-License-Identifier: Apache-2.0
// What a ping says of itself, whichever of the two messages carries it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

struct PingForm {
  DeviceData settings;               ///< and where the head was; without data
  std::optional<AutoTransmit> scan;  ///< that it belongs to; nullopt: it was commanded alone

  bool operator==(const PingForm&) const = default;
};

/// The form of a ping that `command` asks for.
PingForm form_of(const Transducer& command);
/// The form of the ping at one angle of a scan.
/// @param command that began it
/// @param angle where the scan is, 0..399
PingForm form_of(const AutoTransmit& command, int angle);
/// The form of a ping that has come; nullopt: it is another message.
std::optional<PingForm> form_of(const Report& report);
/// The message that carries a ping of this form. It views `data`.
Report message_of(const PingForm& form, std::span<const std::uint8_t> data);

}  // namespace sonard::ping360
