// SPDX-License-Identifier: Apache-2.0
// Configuration that only a head of type `micron` has (docs/configuration.md).
#pragma once

#include "protocol/micron/device_config.hpp"
#include "server/heads/device_settings.hpp"
#include "server/heads/head_config.hpp"
#include "server/net/serial_port.hpp"

namespace sonard::server {

/// The head turns about the z axis of its mount; its "ahead" is the x axis. Its jobs set `range` of the
/// acoustics.
struct MicronConfig final : DeviceSettings {
  micron::DeviceConfig device;
  SerialLinkConfig serial;
  double nominal_gain_db = 36.0;          ///< client's gain at which levels are as in the acoustics; [0, 80]
  double chirp_bandwidth_hz = 100'000.0;  ///< sets the range cell; 0: a pulse of no length
};

/// Default acoustics of such a head.
render::SonarSettings micron_acoustics();

}  // namespace sonard::server
