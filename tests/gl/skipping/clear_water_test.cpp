// SPDX-License-Identifier: Apache-2.0
// SkipRule::clear_water: on against off, over a bed as dark as sand, through the whole receiver.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/gl/skipping/skipping_worlds.hpp"

namespace sonard::render {
namespace {

using namespace test;

class VolumeReverberationRule : public EngineTest {};

INSTANTIATE_TEST_SUITE_P(Engines, VolumeReverberationRule, all_engines(), engine_name);

/// Samples of 16 bits without speckle and noise, 5 m over a bed of -20 dB.
PingRequest request_over_bed(double scattering_db, double range_m) {
  PingRequest request = small_request();
  request.T_world_sonar.position_m.z = 5;
  request.settings.range = {400, range_m / 400, 0, false};
  request.settings.sixteen_bit = true;
  request.settings.physical.speckle = PhysicalModel::Speckle::off;
  request.settings.physical.noise = false;
  request.settings.physical.gain_db = 40;
  request.settings.physical.volume_scattering_db = scattering_db;
  return request;
}

World bed() {
  return make_world({make_body("bed", make_quad({-60, -60, 0}, {120, 0, 0}, {0, 120, 0}), 0.01)});
}

TEST_P(VolumeReverberationRule, LeavesOutWhatIsHardlyHeard) {
  RendererOptions off_options = options();
  off_options.skip.turn_off(SkipRule::clear_water);
  SonarRenderer renderer(bed(), options());
  SonarRenderer off(bed(), off_options);
  double worst = 0;
  for (const auto& [scattering_db, range_m] : {std::pair{-75.1, 50.0}, std::pair{-60.0, 19.9}}) {
    const PingRequest request = request_over_bed(scattering_db, range_m);
    const PingSamples on_samples = renderer.render_ping(request);
    const PingSamples off_samples = off.render_ping(request);
    EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::clear_water), 1u);
    EXPECT_EQ(off.last_statistics().skipped.of(SkipRule::clear_water), 0u);
    const double highest = *std::max_element(off_samples.u16.begin(), off_samples.u16.end());
    EXPECT_GT(highest, 1000);
    EXPECT_LT(highest, 65535);
    double difference = 0;
    for (std::size_t i = 0; i < on_samples.u16.size(); ++i) {
      difference = std::max(difference, std::abs(on_samples.u16[i] - off_samples.u16[i]) / highest);
    }
    std::printf("%g dB/m^3 to %g m: %.4f of the highest code\n", scattering_db, range_m, difference);
    EXPECT_GT(difference, 0);
    worst = std::max(worst, difference);
  }
  EXPECT_LE(worst, entry_of(SkipRule::clear_water).bound);
}

TEST_P(VolumeReverberationRule, KeepsWhatIsHeard) {
  SonarRenderer renderer(bed(), options());
  const PingSamples turbid = renderer.render_ping(request_over_bed(-70, 25));
  EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::clear_water), 0u);
  EXPECT_NE(turbid.u16, renderer.render_ping(request_over_bed(-80, 25)).u16);
}

}  // namespace
}  // namespace sonard::render
