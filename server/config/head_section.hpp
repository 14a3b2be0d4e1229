// SPDX-License-Identifier: Apache-2.0
// The part of the loader that reads one item of `heads`.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "server/config/config.hpp"
#include "server/config/yaml_section.hpp"

namespace sonard::server {

/// What a head takes from the rest of the configuration.
struct HeadContext {
  std::filesystem::path folder;  ///< of the configuration file
  WaterConfig water;             ///< without what depends on the frequency of the device
  /// Negative: computed for the frequency of the device.
  double absorption_db_per_m = -1.0;
  /// Speed the water really has; 0: that of the ping configuration.
  double water_sound_speed_mps = 0.0;
  render::Sampling sampling;
  bool adaptive_quality = false;
  bool pings_by_source = false;  ///< by the clock of the source of the poses
};

/// @param kinds those that a head may be of
HeadConfig read_head(YamlSection& section, const HeadContext& context,
                     std::span<const HeadKind* const> kinds);

/// Name, mount and dump of any head, and the sampling that it takes from the document.
void read_common(YamlSection& section, const HeadContext& context, HeadConfig& head);
/// What the acoustics of all heads have. What stands in `head` is the default; the frequency gives that of
/// the noise budget.
void read_acoustics(YamlSection& section, double carrier_hz, HeadConfig& head);
/// The width of the one beam of a scanning head.
void read_single_beam(YamlSection& section, render::Aperture& aperture);
/// The array and the beams of a multibeam head.
void read_receive_array(YamlSection& section, render::Aperture& aperture);
/// Absorption at the frequency of the head. To be called before the acoustics are read.
void apply_water(YamlSection& section, const HeadContext& context, double carrier_hz, HeadConfig& head);

/// `position_m` and `rpy_deg` (roll, pitch, yaw about fixed x, y, z; positive pitch is nose down), each
/// with its meaning.
void read_pose(YamlSection& section, render::Pose& pose, std::string_view position_meaning,
               std::string_view rpy_meaning);

}  // namespace sonard::server
