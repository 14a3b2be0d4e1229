// SPDX-License-Identifier: Apache-2.0
// The values of one ping: what is asked for, the mean echo, the samples, and what it cost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// The part of a mean echo that single points send back: its amplitude is steady, speckle does not touch it.
struct SteadyEcho {
  std::vector<std::int32_t> row_of_line;  ///< -1: the line has none; empty: no line has
  std::vector<float> intensity;           ///< [row * beams + beam], no more than that of the image

  /// One beam after the other; nullptr: the line has none.
  const float* line(int line, int beams) const {
    const std::int32_t row = row_of_line.empty() ? -1 : row_of_line[static_cast<std::size_t>(line)];
    return row < 0 ? nullptr : &intensity[static_cast<std::size_t>(row) * static_cast<std::size_t>(beams)];
  }
};

/// Mean echo intensity behind array and pulse, before speckle, noise and gain. Linear; mode `physical`: re
/// the source intensity at 1 m, per beam and range bin; mode `paper`: the paper's I_bin in [0, 1].
struct EchoImage {
  int beams = 0;
  int lines = 0;
  std::vector<float> intensity;  ///< [beam * lines + line]
  SteadyEcho steady{};
  /// How much of the strongest echo of each line surfaces send back, in [0, 1]; the rest is the water's.
  /// Empty: all of it.
  std::vector<float> surface_share{};

  float at(int beam, int line) const {
    return intensity[static_cast<std::size_t>(beam) * static_cast<std::size_t>(lines) +
                     static_cast<std::size_t>(line)];
  }
};

/// What the receiver hands to the device, ready to be sent: line after line, each from port to starboard.
struct PingSamples {
  int beams = 0;
  int lines = 0;                   ///< after range compression
  std::vector<std::uint8_t> u8;    ///< [line * beams + beam], when 8 bit were asked for
  std::vector<std::uint16_t> u16;  ///< [line * beams + beam], when 16 bit were asked for
};

struct PingRequest {
  Pose T_world_sonar;  ///< when the ping is sent
  SonarSettings settings;
  std::uint64_t ping_number = 0;  ///< enters the random numbers; never wraps
  std::uint64_t seed = 0;
  /// When the echo of the last line returns, 2 R / c later; nullopt: the sonar is at rest
  /// (docs/physics.md 2.14).
  std::optional<Pose> T_world_sonar_at_end{};
};

/// A ping of one of the sonars that share a renderer.
struct StreamPing {
  int stream = 0;
  PingRequest request;
};

/// Seconds spent, and how much work there was. For logs, metrics and the benchmark.
struct PingStatistics {
  double visibility_s = 0.0;
  double binning_s = 0.0;
  double multipath_s = 0.0;
  double azimuth_pattern_s = 0.0;
  double pulse_s = 0.0;
  double receiver_s = 0.0;
  std::uint64_t samples = 0;
  /// False: no surface is in range and fan. What surfaces mirror and water scatters may still be.
  bool sees_surface = true;
  /// Intensity of the strongest echo of a surface re what hides it in its range bin: the mean noise, or half
  /// a step of the samples. 0: no echo. Infinite in mode `paper`, which has no noise.
  double echo_over_floor = std::numeric_limits<double>::infinity();
  std::uint64_t invalid_samples = 0;  ///< NaN or infinite: dropped
  /// Echoes beyond what the sums of GpuBinner hold, taken as that: 2^14 times unit response or more.
  std::uint64_t saturated_samples = 0;
  // Of the GPU engine: how often it drew, what it read back, and how often it waited for that.
  std::uint64_t passes = 0;
  std::uint64_t bytes_read_back = 0;
  std::uint64_t synchronisations = 0;
  // Of all its passes:
  std::uint64_t views = 0;
  std::uint64_t pixels = 0;            ///< of all views, whatever they saw
  std::uint64_t draw_calls = 0;        ///< chunks of meshes that were left after culling
  std::uint64_t triangles = 0;         ///< of these
  std::uint64_t atomic_additions = 0;  ///< of binning, modulo 2^32 for each page of the image
  std::uint64_t bytes_uploaded = 0;    ///< into buffers; with meshes and normal maps that were not there yet
  std::uint64_t video_memory_bytes = 0;  ///< meshes and normal maps in video memory after the ping
  double preparing_s =
      0.0;             ///< of visibility_s and binning_s, what the CPU takes to cull and to lay out grids
  SkipCounts skipped;  ///< what was left out; stages that did not run have counted nothing
};

}  // namespace sonard::render
