// SPDX-License-Identifier: Apache-2.0
// How patches become an image, and the image with what it took.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/engine.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

struct BinningOptions {
  bool mean = false;              ///< divide by the solid angle that fell into the line (mode `paper`)
  bool footprint = true;          ///< false: a sample is a point in range
  bool legacy_bin_index = false;  ///< docs/physics.md 1.2, A4; only with footprint = false
  bool open_water = false;        ///< fill BinningResult::open_sr; not with `mean`
  float largest_response = 1.0F;  ///< of any sample of a grid; sets how fine the sums are
  /// Beams are told apart by cones, and these are the beams (ConeBearings); null: by azimuth. With
  /// footprints.
  const Aperture* cone_aperture = nullptr;
  SkipSwitches skip{};  ///< for SkipRule::empty_beams, of slices
};

/// Means are not taken where less than this share of a beam is seen: there the weights are mostly rounding.
inline constexpr float least_share = 0x1p-32F;
/// A beam that is open to less than this share is blocked: what remains is the error of the solid angles.
inline constexpr double least_open = 2e-3;

struct BinningResult {
  int beams = 0;
  int lines = 0;
  std::vector<float> echo;     ///< [beam * lines + line], as the image of MeanEcho
  std::vector<float> open_sr;  ///< see MeanEcho::open_sr
  std::uint64_t samples = 0;
  std::uint64_t invalid_samples = 0;
  std::uint64_t saturated_samples = 0;  ///< of GpuBinner: echoes beyond what its sums hold, taken as that
  SkipCounts skipped;
  double shading_s = 0.0;  ///< of slices: the part of the time in which patches were made
};

/// How the image of a request is binned.
/// @param largest_response of any surface of the world
BinningOptions binning_options(const EchoRequest& request, const SkipSwitches& skip, float largest_response);

/// Makes a mean echo of what was binned, and adds what binning has counted to the statistics.
void hand_over(BinningResult&& bins, MeanEcho& echo, PingStatistics& statistics);

}  // namespace sonard::render
