// SPDX-License-Identifier: Apache-2.0
#include "tests/gl/accuracy/accuracy_case.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/bench/image_error.hpp"

namespace sonard::test {

namespace {

/// The largest error of the best 99 % of the beams. NaN, which fails every limit, if any error is NaN.
double kept_by_most(const std::vector<bench::BeamError>& errors, double bench::BeamError::*which) {
  constexpr double most = 0.99;
  double worst = 0.0;
  std::vector<double> values;
  for (const bench::BeamError& error : errors) {
    values.push_back(error.*which);
    worst = values.back() <= worst ? worst : values.back();
  }
  if (values.empty() || std::isnan(worst)) {
    return worst;
  }
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(std::ceil(most * static_cast<double>(values.size()))) - 1];
}

}  // namespace

AccuracyLimits targets_of(render::Sampling::Preset preset) {
  if (preset == render::Sampling::Preset::fast) {
    return {.bin_rms = 0.05,
            .beam_total = 0.005,
            .first_echo_bins = 1,
            .centroid_bins = 0.5,
            .bearing_beams = 1,
            .bearing_centroid = 0.25,
            .hole_fraction = 0.001,
            .shadow_bins = 2,
            .shadow_beams = 1,
            .pipes_detected = 0.95};
  }
  return {.bin_rms = 0.01,
          .beam_total = 0.001,
          .first_echo_bins = 0.5,
          .centroid_bins = 0.1,
          .bearing_beams = 0.5,
          .bearing_centroid = 0.05,
          .hole_fraction = 0,
          .shadow_bins = 1,
          .shadow_beams = 0.5,
          .pipes_detected = 1};
}

ImageAccuracy measure(const render::EchoImage& image, const render::EchoImage& truth) {
  const auto error = bench::compare_images(image, truth).value();
  const std::vector<bench::BeamError> beams = bench::compare_beams(image, truth);
  return {.bin_rms = error.bin_rms,
          .beam_total = kept_by_most(beams, &bench::BeamError::total),
          .first_echo_bins = kept_by_most(beams, &bench::BeamError::first_echo_lines),
          .centroid_bins = kept_by_most(beams, &bench::BeamError::centroid_lines),
          .hole_fraction = error.hole_fraction};
}

std::string name_of(const AccuracyCase& one) {
  return std::string(render::name_of(one.engine)) +
         (one.preset == render::Sampling::Preset::fast ? "_fast" : "_default");
}

void AccuracyTest::SetUp() {
  if (GetParam().engine == render::EngineKind::gpu) {
    require_gl();
  }
}

render::EchoImage AccuracyTest::render(const Scene& scene) const {
  render::SonarRenderer renderer(scene.world, options());
  render::PingRequest request = scene.request();
  request.settings.sampling = {.preset = GetParam().preset};
  return renderer.render_echo(request);
}

void AccuracyTest::expect_within(const AccuracyLimits& limits, const ImageAccuracy& found,
                                 const std::string& what) {
  std::printf("%s: bins %.5f, holes %.6f\n", what.c_str(), found.bin_rms, found.hole_fraction);
  EXPECT_LE(found.bin_rms, limits.bin_rms) << what;
  EXPECT_LE(found.hole_fraction, limits.hole_fraction) << what;
  std::printf("%s: 99 %% of beams: total %.5f, first echo %.3f bins, centroid %.4f bins\n", what.c_str(),
              found.beam_total, found.first_echo_bins, found.centroid_bins);
  EXPECT_LE(found.beam_total, limits.beam_total) << what;
  EXPECT_LE(found.first_echo_bins, limits.first_echo_bins) << what;
  EXPECT_LE(found.centroid_bins, limits.centroid_bins) << what;
}

Scene forward_looking_scene(std::vector<render::Body> bodies, const render::RangeBins& range) {
  Scene scene;
  scene.world = make_world(std::move(bodies));
  scene.settings.aperture.beam_edges_rad = render::equal_angle_edges(256, 2 * std::numbers::pi / 3);
  scene.settings.range = range;
  scene.settings.physical.absorption_db_per_m = 0;
  return scene;
}

}  // namespace sonard::test
