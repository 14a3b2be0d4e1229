// SPDX-License-Identifier: Apache-2.0
// The values of one ping: the request, the mean echo, the samples, and the cost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// The part of a mean echo that comes from single points. Its amplitude is steady: speckle does not change
/// it.
struct SteadyEcho {
  std::vector<std::int32_t> row_of_line;  ///< -1: no steady echo in the range bin; empty: in no bin
  std::vector<float> intensity;           ///< [row * beams + beam], at most EchoImage::intensity

  /// The intensities of a range bin by beam; nullptr if the bin has no steady echo.
  const float* line(int line, int beams) const {
    const std::int32_t row = row_of_line.empty() ? -1 : row_of_line[static_cast<std::size_t>(line)];
    return row < 0 ? nullptr : &intensity[static_cast<std::size_t>(row) * static_cast<std::size_t>(beams)];
  }
};

/// Mean echo intensity after array and pulse, before speckle, noise and gain. Linear, per beam and range bin.
/// Mode `physical`: re the source intensity at 1 m; mode `paper`: the paper's I_bin in [0, 1].
struct EchoImage {
  int beams = 0;
  int bins = 0;                  ///< range bins
  std::vector<float> intensity;  ///< [beam * bins + bin]
  SteadyEcho steady{};
  /// Share of each range bin's strongest echo that comes from surfaces, in [0, 1]; the rest comes from the
  /// water. Empty: 1 in all bins.
  std::vector<float> surface_share{};

  float at(int beam, int bin) const {
    return intensity[static_cast<std::size_t>(beam) * static_cast<std::size_t>(bins) +
                     static_cast<std::size_t>(bin)];
  }
};

/// Output of the receiver, ready for the device to send: bin by bin, each from port to starboard. With
/// SonarSettings::directions there are no bins.
struct PingSamples {
  int beams = 0;
  int bins = 0;                    ///< range bins after range compression
  std::vector<std::uint8_t> u8;    ///< [bin * beams + beam], if the output has 8 bits
  std::vector<std::uint16_t> u16;  ///< [bin * beams + beam], if the output has 16 bits
  DirectionEchoes directions{};    ///< only with SonarSettings::directions
};

struct PingRequest {
  Pose T_world_sonar;  ///< at the transmit time
  SonarSettings settings;
  std::uint64_t ping_number = 0;  ///< seeds the random numbers; never wraps
  std::uint64_t seed = 0;
  /// At the return of the last bin's echo, 2 R / c later; nullopt: the sonar is at rest (docs/physics.md
  /// 2.14).
  std::optional<Pose> T_world_sonar_at_end{};
};

/// A ping of one of the heads that share a renderer.
struct HeadRequest {
  int head = 0;  ///< its index
  PingRequest request;
};

/// Work for presets, as the GPU has counted it in the last pass.
struct GpuWork {
  std::uint64_t dispatches = 0;  ///< of all passes
  std::uint64_t triangles = 0;   ///< in the fan
  std::uint64_t entries = 0;     ///< of these, in the lists of all beams
  std::uint64_t rounds = 0;      ///< that see slices
  std::uint64_t slices = 0;      ///< seen or taken over from the slice that they replace
  std::uint64_t segments = 0;    ///< triangles cut by slices, and sorted
  std::uint64_t visible = 0;     ///< segments, or parts of segments
  std::uint64_t additions = 0;   ///< atomic, to 32-bit words of the sums over range
};

/// Cost of a ping on the GPU; engine `gpu` only.
struct GpuCost {
  std::uint64_t passes = 0;  ///< images made: more than one if buffers were too small
  std::uint64_t bytes_read_back = 0;
  std::uint64_t synchronisations = 0;  ///< waits for the GPU
  GpuWork work{};
  std::map<std::string, double> stages_ms{};  ///< by the file of a shader; see GpuOptions::time_stages
  std::uint64_t bytes_uploaded = 0;           ///< into buffers, including new meshes and normal maps
  std::uint64_t video_memory_bytes = 0;       ///< meshes and normal maps in video memory after the ping
};

/// Seconds of rendering, by stage.
struct StageSeconds {
  double visibility = 0.0, binning = 0.0, multipath = 0.0, azimuth_pattern = 0.0, pulse = 0.0, receiver = 0.0;

  StageSeconds& operator+=(const StageSeconds& more) {
    visibility += more.visibility;
    binning += more.binning;
    multipath += more.multipath;
    azimuth_pattern += more.azimuth_pattern;
    pulse += more.pulse;
    receiver += more.receiver;
    return *this;
  }
};

/// Time spent and amount of work, for logs, metrics and the benchmark.
struct PingStatistics {
  StageSeconds seconds{};
  std::uint64_t samples = 0;
  /// False if no surface is within range and fan. Mirrored surfaces and volume scattering may still give
  /// echoes.
  bool sees_surface = true;
  /// Intensity of the strongest surface echo over the floor of its range bin: the mean noise, or half a step
  /// of the samples. 0: no echo. Infinite in mode `paper`, which has no noise.
  double echo_over_floor = std::numeric_limits<double>::infinity();
  std::uint64_t invalid_samples = 0;  ///< NaN or infinite: dropped
  GpuCost gpu{};
  SkipCounts skipped;  ///< stages that did not run count nothing
};

}  // namespace sonard::render
