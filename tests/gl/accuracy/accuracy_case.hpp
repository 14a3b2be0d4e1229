// SPDX-License-Identifier: Apache-2.0
// The errors that each preset may make (docs/accuracy.md), and the comparison of an image with them.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "renderer/ping.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {

/// Largest errors that a preset may make (docs/accuracy.md). "Bins" are range lines.
struct AccuracyLimits {
  double bin_rms;           ///< pooled over all bins above 1e-2 of their beam's maximum
  double beam_total;        ///< relative, of 99 % of the beams
  double first_echo_bins;   ///< of 99 % of the beams
  double centroid_bins;     ///< of the echo in range, of 99 % of the beams
  double bearing_beams;     ///< of the strongest beam
  double bearing_centroid;  ///< of the echo across beams, beams
  double hole_fraction;     ///< of the same bins as bin_rms
  double shadow_bins, shadow_beams;
  double pipes_detected;  ///< least share
};

AccuracyLimits targets_of(render::Sampling::Preset preset);

/// The errors of an image against its truth. Errors per beam are the largest of the best 99 % of the beams.
struct ImageAccuracy {
  double bin_rms = 0, beam_total = 0, first_echo_bins = 0, centroid_bins = 0, hole_fraction = 0;
};

ImageAccuracy measure(const render::EchoImage& image, const render::EchoImage& truth);

struct AccuracyCase {
  render::EngineKind engine;
  render::Sampling::Preset preset;
};

/// For example `cpu_default`; the list of tests shows it too.
std::string name_of(const AccuracyCase& one);

class AccuracyTest : public ::testing::TestWithParam<AccuracyCase> {
 protected:
  void SetUp() override;

  AccuracyLimits targets() const { return targets_of(GetParam().preset); }

  render::RendererOptions options() const { return {GetParam().engine, 0}; }
  /// The scene's image at the preset.
  render::EchoImage render(const Scene& scene) const;

  /// Prints the errors under `what` and asserts the limits.
  static void expect_within(const AccuracyLimits& limits, const ImageAccuracy& found,
                            const std::string& what);
};

inline auto all_cases() {
  using Preset = render::Sampling::Preset;
  return ::testing::Values(AccuracyCase{render::EngineKind::cpu, Preset::fast},
                           AccuracyCase{render::EngineKind::cpu, Preset::normal},
                           AccuracyCase{render::EngineKind::gpu, Preset::fast},
                           AccuracyCase{render::EngineKind::gpu, Preset::normal});
}
inline std::string case_name(const ::testing::TestParamInfo<AccuracyCase>& info) {
  return name_of(info.param);
}

/// The scene of the targets: 256 beams over 120 x 20 degrees, no absorption, mu = 1.
/// @param range by default 1000 lines of 20 mm
Scene forward_looking_scene(std::vector<render::Body> bodies,
                            const render::RangeBins& range = {1000, 0.02, 0, false});

}  // namespace sonard::test
