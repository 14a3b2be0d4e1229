// SPDX-License-Identifier: Apache-2.0
// What only a head of type `gemini_720i` has in the configuration (docs/configuration.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/gemini/device_config.hpp"
#include "server/config/config.hpp"
#include "server/config/status_destination.hpp"
#include "server/net/faulty_link.hpp"

namespace sonard::server {

/// The sonar's x axis is the acoustic axis, so a down tilt is in the mount. The bearing table of the device
/// and its jobs fill in `aperture.beam_edges_rad` and `range` of the acoustics.
struct GeminiConfig final : DeviceSettings {
  /// Identity, addresses and timing. `water_sound_speed_mps` is already chosen (0: follow the ping
  /// configuration).
  gemini::DeviceConfig device;
  /// Whether beams point elsewhere in water of another sound speed than the head assumes, as those of a flat
  /// array do (docs/physics.md 2.12).
  bool steering_error = false;
  /// Address of the command socket: one of this machine, or 0 for all of them.
  Ipv4 bind_address = 0x7F000002;
  std::uint16_t command_port = 52901;  ///< the head listens here and sends from here
  /// By whose name the address and the mask are given, and followed; empty: as numbers.
  std::string interface, netmask_interface;
  StatusDestination status;
  AllowList allow;  ///< clients that are served; status packets are not affected

  LinkConfig link;
  /// A UDP socket whose every datagram counts as one edge of the external trigger (run mode 2).
  std::optional<Endpoint> trigger;
};

/// The configuration of a head of this type.
inline const GeminiConfig& gemini_config(const HeadConfig& head) {
  return static_cast<const GeminiConfig&>(*head.device);
}

/// The acoustics of such a head, where nothing is configured.
render::SonarSettings gemini_acoustics();

}  // namespace sonard::server
