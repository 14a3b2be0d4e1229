// SPDX-License-Identifier: Apache-2.0
#include "server/devices/gemini/settings.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "server/devices/gemini/type.hpp"
#include "tests/support/degree.hpp"

namespace sonard::server {
namespace {

HeadConfig plain_head() {
  return gemini_type().make_default();
}

PingJob job_at_20_m() {
  PingJob job;
  job.number = 300;
  job.native_bins = 2411;  // round(20 / (1500 / 2 / 90422)) (protocol/gemini/README.md 5)
  job.native_bin_m = 1500.0 / (2 * 90422.0);
  job.compression_log2 = 1;
  job.gain_db = -4.5;
  job.sound_speed_mps = 1500.0;
  return job;
}

TEST(GeminiSettings, BeamsFallFromPortToStarboardOverTheSector) {
  const render::SonarSettings settings = gemini_sonar_settings(job_at_20_m(), plain_head());
  const std::vector<double>& edges = settings.aperture.beam_edges_rad;
  ASSERT_EQ(edges.size(), 257u);
  EXPECT_NEAR(edges.front(), 60 * degree, 1e-12);
  EXPECT_NEAR(edges[128], 0.0, 1e-12);
  EXPECT_NEAR(edges.back(), -60 * degree, 1e-12);
  EXPECT_TRUE(std::is_sorted(edges.rbegin(), edges.rend()));
}

// Bearings printed in protocol/gemini/README.md 6.5, positive to starboard. Each is in the middle of its
// beam, by its sine.
TEST(GeminiSettings, BeamsHoldTheBearingsOfTheDocument) {
  const render::SonarSettings settings = gemini_sonar_settings(job_at_20_m(), plain_head());
  const std::vector<double>& edges = settings.aperture.beam_edges_rad;
  const struct {
    std::size_t beam;
    double bearing_deg;
  } rows[] = {{0, -59.615}, {1, -58.857}, {2, -58.115}, {127, -0.194}, {128, 0.194}, {255, 59.615}};
  for (const auto& row : rows) {
    const double middle_sin = (std::sin(edges[row.beam]) + std::sin(edges[row.beam + 1])) / 2;
    EXPECT_NEAR(std::asin(middle_sin) / degree, -row.bearing_deg, 6e-4) << "beam " << row.beam;
  }
}

TEST(GeminiSettings, RangeBinsAreFromTheJob) {
  const render::SonarSettings settings = gemini_sonar_settings(job_at_20_m(), plain_head());
  EXPECT_EQ(settings.range.count, 2411);
  EXPECT_EQ(settings.range.output_count(), 1205);
  EXPECT_NEAR(settings.range.step_m, 0.008294, 1e-6);
  EXPECT_NEAR(settings.range.max_range_m(), 20.0, 0.01);
  EXPECT_FALSE(settings.range.compression_peak);
  EXPECT_FALSE(settings.sixteen_bit);
}

TEST(GeminiSettings, SampleSizeFollowsTheJob) {
  PingJob job = job_at_20_m();
  job.sixteen_bit = true;
  EXPECT_TRUE(gemini_sonar_settings(job, plain_head()).sixteen_bit);
}

TEST(GeminiSettings, HeadThatOnlyListensTransmitsNothing) {
  PingJob job = job_at_20_m();
  EXPECT_TRUE(gemini_sonar_settings(job, plain_head()).transmit);
  job.transmit = false;
  EXPECT_FALSE(gemini_sonar_settings(job, plain_head()).transmit);
}

TEST(GeminiSettings, GainIsAddedAndTheRestComesFromTheHead) {
  HeadConfig head = plain_head();
  render::SonarSettings& acoustics = head.acoustics;
  acoustics.model = render::Model::physical;
  acoustics.physical.gain_db = 50.0;
  acoustics.physical.absorption_db_per_m = 0.123;
  acoustics.aperture.vertical_beamwidth_rad = 0.2;
  acoustics.sampling.rows = 77;
  const render::SonarSettings settings = gemini_sonar_settings(job_at_20_m(), head);
  EXPECT_DOUBLE_EQ(settings.physical.gain_db, 45.5);
  EXPECT_DOUBLE_EQ(settings.physical.absorption_db_per_m, 0.123);
  EXPECT_DOUBLE_EQ(settings.aperture.vertical_beamwidth_rad, 0.2);
  EXPECT_EQ(settings.sampling.rows, 77);
}

}  // namespace
}  // namespace sonard::server
