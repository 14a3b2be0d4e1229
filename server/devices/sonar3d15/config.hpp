// SPDX-License-Identifier: Apache-2.0
// Configuration that only a head of type `sonar3d15` has (docs/configuration.md).
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "protocol/sonar3d15/device_config.hpp"
#include "server/heads/device_settings.hpp"
#include "server/heads/head_config.hpp"
#include "server/net/addresses.hpp"

namespace sonard::server {

/// Values that change with the head's frequency. Its fields of view are in the settings of the device.
struct Sonar3d15ModeAcoustics {
  double horizontal_beamwidth_rad = 0.0, vertical_beamwidth_rad = 0.0;  ///< -3 dB full width
  double absorption_db_per_m = 0.0;                                     ///< one way
};

/// The x axis of the mount is the axis of the field of view. Jobs set directions, range and frequency.
struct Sonar3d15Config final : DeviceSettings {
  static constexpr std::uint16_t id = 0;  ///< there is none on the wire
  sonar3d15::DeviceConfig device;
  Ipv4 address = 0;       ///< of the HTTP interface, and source of the images
  std::string interface;  ///< that gives, and keeps updating, the address; empty: given as numbers
  std::uint16_t http_port = 80;
  int multicast_ttl = 1;
  AllowList allow;                              ///< clients of the HTTP interface
  std::array<Sonar3d15ModeAcoustics, 2> modes;  ///< low frequency, high frequency
};

/// A head with the beams of the maker's product page, and the absorption in default water.
Sonar3d15Config sonar3d15_defaults();

}  // namespace sonard::server
