// SPDX-License-Identifier: Apache-2.0
// Value ranges that a head accepts in commands (protocol/ping360/README.md 2.3).
#pragma once

#include <optional>
#include <string_view>

#include "protocol/ping360/device_config.hpp"
#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

/// The first field of a command with a refused value.
struct OutOfRange {
  std::string_view field;  ///< name as in the layout tables
  int value = 0;
  int least = 0;
  int most = 0;

  bool operator==(const OutOfRange&) const = default;
};

std::optional<OutOfRange> out_of_range(const Transducer& command, const DeviceConfig& config);
std::optional<OutOfRange> out_of_range(const AutoTransmit& command, const DeviceConfig& config);

/// A limit of a scan in gradians, 0..399, read as signed or unsigned (DeviceConfig::signed_scan_angles).
int scan_angle(std::uint16_t angle, const DeviceConfig& config);

}  // namespace sonard::ping360
