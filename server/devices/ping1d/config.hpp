// SPDX-License-Identifier: Apache-2.0
// Configuration that only a head of type `ping1d` has (docs/configuration.md).
#pragma once

#include <cstdint>

#include "protocol/ping1d/device_config.hpp"
#include "server/devices/ping/lines.hpp"
#include "server/heads/head_config.hpp"

namespace sonard::server {

/// Port of the bridge of a vehicle for the first such head (protocol/ping1d/README.md 4).
inline constexpr std::uint16_t ping1d_bridge_port = 9090;

/// The beam looks along the x axis of its mount. Its jobs set `range` of the acoustics.
struct Ping1dConfig final : PingHeadConfig<ping1d::DeviceConfig> {};

/// The two devices of this type.
enum class Ping1dModel : std::uint8_t { ping1d, ping2 };

/// Default acoustics of such a head.
render::SonarSettings ping1d_acoustics(Ping1dModel model);

}  // namespace sonard::server
