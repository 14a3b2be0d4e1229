// SPDX-License-Identifier: Apache-2.0
// Configuration that only a head of type `ping1d` has (docs/configuration.md).
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/ping1d/device_config.hpp"
#include "server/heads/device_settings.hpp"
#include "server/heads/head_config.hpp"
#include "server/net/serial_port.hpp"
#include "server/net/udp_transport.hpp"

namespace sonard::server {

/// Port of the bridge of a vehicle for the first such head (docs/protocols/ping1d.md 4).
inline constexpr std::uint16_t ping1d_bridge_port = 9090;

/// The beam looks along the x axis of its mount. Its jobs set `range` of the acoustics.
struct Ping1dConfig final : DeviceSettings {
  ping1d::DeviceConfig device;
  std::vector<UdpTransportConfig> udp;  ///< channels 0, 1, ... of the device; all have the faults of one link
  /// The channel after the UDP channels; without tcp, udp and pty there is no serial line.
  SerialLinkConfig serial;
};

/// The two devices of this type.
enum class Ping1dModel : std::uint8_t { ping1d, ping2 };

/// Default acoustics of such a head.
render::SonarSettings ping1d_acoustics(Ping1dModel model);

}  // namespace sonard::server
