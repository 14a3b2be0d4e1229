// SPDX-License-Identifier: Apache-2.0
// Configuration that only a head of type `gemini_720i` has (docs/configuration.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/gemini/device_config.hpp"
#include "server/heads/device_settings.hpp"
#include "server/heads/head_config.hpp"
#include "server/net/addresses.hpp"
#include "server/net/faulty_link.hpp"
#include "server/yaml/status_destination.hpp"

namespace sonard::server {

/// The sonar's x axis is the acoustic axis, so the mount includes any down tilt. The bearing table of the
/// device and its jobs set `aperture.beam_edges_rad` and `range` of the acoustics.
struct GeminiConfig final : DeviceSettings {
  /// Identity, addresses and timing. `water_sound_speed_mps` is already resolved (0: follow the ping
  /// configuration).
  gemini::DeviceConfig device;
  /// True if beams are steered wrongly when the sound speed differs from the speed that the head assumes, as
  /// in a flat array (docs/physics.md 2.12).
  bool steering_error = false;
  /// Address of the command socket: one of this machine, or 0 for all of them.
  Ipv4 bind_address = 0x7F000002;
  std::uint16_t command_port = 52901;  ///< the head receives and sends on this port
  /// Interfaces that give, and keep updating, the address and the mask; empty: given as numbers.
  std::string interface, netmask_interface;
  StatusDestination status;
  AllowList allow;  ///< clients that are served; does not affect status packets

  LinkConfig link;
  /// A UDP socket on which every datagram counts as one edge of the external trigger (run mode 2).
  std::optional<Endpoint> trigger;
};

/// Default acoustics of such a head.
render::SonarSettings gemini_acoustics();

}  // namespace sonard::server
