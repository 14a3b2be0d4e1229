// SPDX-License-Identifier: Apache-2.0
// Keys that all heads of the Ping protocol have.
#pragma once

#include <cstdint>
#include <string_view>

#include "protocol/ping/clients.hpp"
#include "protocol/ping/messages.hpp"
#include "server/devices/ping/lines.hpp"
#include "server/heads/head_section.hpp"

namespace sonard::server {

inline constexpr double minute_ms = 60'000.0;

/// What the configuration sets for all heads: simulated time and the speed of sound.
template <class DeviceConfig>
void apply_context(const HeadContext& context, DeviceConfig& device) {
  device.simulated_time = context.simulated_time;
  if (context.water_sound_speed_mps > 0.0) {
    device.water_sound_speed_mps = context.water_sound_speed_mps;
  }
}

/// Keys `link`, `udp`, `serial` and `lock_to_first`.
/// `udp_meaning` is that of an address of `udp`, with its usual ports.
void read_lines(YamlSection& section, const HeadContext& context, std::string_view udp_meaning,
                PingLines& lines, ping::ClientsConfig& clients);
/// Reports a lock to the first client that would never end. Call it when all keys are read.
void check_lock(YamlSection& section, const ping::ClientsConfig& clients);

/// What the head reports about itself: id, revision and firmware.
/// The texts are the meanings of the revision and of the minor version of the firmware.
void read_identity(YamlSection& section, int least_id, std::string_view revision_meaning,
                   std::string_view minor_meaning, std::uint8_t& id, ping::DeviceInformation& information);
/// Keys `fan_out` and `max_clients`.
/// `asker_does` is what else makes a client a receiver.
void read_receivers(YamlSection& section, std::string_view asker_does, ping::ClientsConfig& clients);
/// Key `scale` of a section `timing`.
void read_time_scale(YamlSection& section, double& time_scale);

}  // namespace sonard::server
