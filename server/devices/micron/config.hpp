// SPDX-License-Identifier: Apache-2.0
// What only a head of type `micron` has in the configuration (docs/configuration.md).
#pragma once

#include "protocol/micron/device_config.hpp"
#include "server/config/config.hpp"
#include "server/net/serial_port.hpp"

namespace sonard::server {

/// The head turns about the z axis of its mount, and looks along x where it says "ahead". Its jobs fill in
/// `range` of the acoustics.
struct MicronConfig final : DeviceSettings {
  micron::DeviceConfig device;
  SerialLinkConfig serial;
  double nominal_gain_db = 36.0;  ///< of the client's, at which the level is that of the acoustics; [0, 80]
  double chirp_bandwidth_hz = 100'000.0;  ///< sets the range cell; 0: a pulse without length
};

/// The configuration of a head of this type.
inline const MicronConfig& micron_config(const HeadConfig& head) {
  return static_cast<const MicronConfig&>(*head.device);
}

/// The acoustics of such a head, where nothing is configured.
render::SonarSettings micron_acoustics();

}  // namespace sonard::server
