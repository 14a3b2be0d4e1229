// SPDX-License-Identifier: Apache-2.0
// Configuration that only a head of type `ping360` has (docs/configuration.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "protocol/ping360/device_config.hpp"
#include "renderer/acoustics/transducer.hpp"
#include "renderer/acoustics/water.hpp"
#include "server/devices/ping/lines.hpp"
#include "server/heads/head_config.hpp"

namespace sonard::server {

/// Destination port of clients that have found the head (protocol/ping360/README.md 4.1).
inline constexpr std::uint16_t ping360_data_port = 12345;

/// Transmit frequency at boot (protocol/ping360/README.md 2.3); levels refer to it.
inline constexpr double ping360_carrier_hz = 740'000.0;

/// The socket that answers discovery requests (protocol/ping360/README.md 5).
struct DiscoveryConfig {
  Endpoint bind{0, 30303};
  Ipv4 address = 0;  ///< in the answer: an address at which a socket of `udp` is reached
  std::array<std::uint8_t, 6> mac{0x54, 0x10, 0xEC, 0x12, 0x34, 0x56};
  AllowList allow;
};

/// The head turns about the z axis of its mount; the angle `device.bearing_offset` is along x. Its jobs set
/// `range` of the acoustics.
struct Ping360Config final : PingHeadConfig<ping360::DeviceConfig> {
  std::optional<DiscoveryConfig> discovery;
  /// Clients choose the frequency. The maker calls 650 to 850 kHz usable (protocol/ping360/README.md 9).
  render::TransducerBand transducer_band{650e3, 850e3};
  /// Sets absorption by frequency; nullopt: the configuration sets the absorption.
  std::optional<render::Water> water = render::Water{};
};

/// Default acoustics of such a head.
render::SonarSettings ping360_acoustics();

}  // namespace sonard::server
