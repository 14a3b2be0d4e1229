// SPDX-License-Identifier: Apache-2.0
// Options and result of binning, which makes an image of patches.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/aperture.hpp"
#include "renderer/engine.hpp"
#include "renderer/skip_ledger.hpp"

namespace sonard::render {

struct BinningOptions {
  bool mean = false;              ///< divide by the solid angle that fell into the line (mode `paper`)
  bool footprint = true;          ///< false: a sample is a point in range
  bool legacy_bin_index = false;  ///< docs/physics.md 1.2, A4; only with footprint = false
  bool open_water = false;        ///< fill BinningResult::open_sr; not with `mean`
  float largest_response = 1.0F;  ///< of any sample of a grid; sets the resolution of the sums
  /// The beams, if they are cones (ConeBearings); null: beams are azimuths. Only with footprints.
  const Aperture* cone_aperture = nullptr;
  SkipSwitches skip{};  ///< for SkipRule::empty_beams, with slices
};

/// Share of a beam in a line below which its mean fades, in proportion to the share (docs/physics.md 1.2,
/// A12): a sample of 3 views of 256 x 512 samples for 256 beams.
inline constexpr float full_share = 1.0F / 1536;
/// The same for samples that are points: each one counts, whatever its share.
inline constexpr float full_share_of_points = 0x1p-32F;
/// Open share of a beam below which it is blocked: the rest is the error of the solid angles.
inline constexpr double least_open = 2e-3;

struct BinningResult {
  int beams = 0;
  int lines = 0;
  std::vector<float> echo;     ///< [beam * lines + line], see MeanEcho::image
  std::vector<float> open_sr;  ///< see MeanEcho::open_sr
  std::uint64_t samples = 0;
  std::uint64_t invalid_samples = 0;
  SkipCounts skipped;
  double shading_s = 0.0;  ///< slices only: time in which patches were made
};

/// Options for the image of a request.
/// @param largest_response of any surface of the world
BinningOptions binning_options(const EchoRequest& request, const SkipSwitches& skip, float largest_response);

/// Moves a result into a mean echo and adds its counts to the statistics.
void hand_over(BinningResult&& bins, MeanEcho& echo, PingStatistics& statistics);

}  // namespace sonard::render
