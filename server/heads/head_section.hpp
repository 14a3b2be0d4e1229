// SPDX-License-Identifier: Apache-2.0
// The part of the loader that reads one item of `heads`.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "server/heads/head_config.hpp"
#include "server/heads/water_config.hpp"
#include "server/yaml/yaml_section.hpp"

namespace sonard::server {

/// The values of the rest of the configuration that a head uses.
struct HeadContext {
  std::filesystem::path folder;  ///< of the configuration file
  WaterConfig water;             ///< without values that depend on the device's frequency
  /// If negative, computed for the frequency of the device.
  double absorption_db_per_m = -1.0;
  /// True speed of sound in the water; 0: the speed in the ping configuration.
  double water_sound_speed_mps = 0.0;
  render::Sampling sampling;
  bool adaptive_quality = false;
  bool simulated_time = false;  ///< the stamps of the poses time the pings
};

/// @param types the permitted types of heads
HeadConfig read_head(YamlSection& section, const HeadContext& context,
                     std::span<const HeadType* const> types);

/// Keys of any head: name, mount and dump. Copies the sampling from the context.
void read_common(YamlSection& section, const HeadContext& context, HeadConfig& head);
/// Acoustics keys of all heads. The values in `head` are the defaults; the frequency gives the default of the
/// noise budget.
void read_acoustics(YamlSection& section, double carrier_hz, HeadConfig& head);
/// The width of the one beam of a scanning head.
void read_single_beam(YamlSection& section, render::Aperture& aperture);
/// The array and the beams of a multibeam head.
void read_receive_array(YamlSection& section, render::Aperture& aperture);
/// Absorption at the frequency of the head. Call it before read_acoustics().
void apply_water(YamlSection& section, const HeadContext& context, double carrier_hz, HeadConfig& head);
/// Warns if the formula of the absorption is not valid at a frequency.
/// @param remedy the key that sets the absorption at this frequency
void warn_of_absorption(YamlSection& section, const WaterConfig& water, double carrier_hz,
                        std::string_view remedy);

}  // namespace sonard::server
