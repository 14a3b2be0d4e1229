// SPDX-License-Identifier: Apache-2.0
// What `sonard render` makes of the echoes of a Sonar 3D-15, and the options that it refuses.
#include "server/devices/sonar3d15/survey.hpp"

#include <gtest/gtest.h>
#include <CLI/Error.hpp>

#include "protocol/sonar3d15/shot.hpp"
#include "server/devices/sonar3d15/type.hpp"

namespace sonard::server {
namespace {

std::unique_ptr<Survey> survey(const SurveyOptions& options = {}) {
  return sonar3d15_type().survey(sonar3d15_type().make_default(), options);
}

TEST(Sonar3d15Survey, MeasuresAsTheHeadDoesAndRecordsBothImages) {
  const std::unique_ptr<Survey> shots = survey();
  const PingJob job = shots->job(3);
  EXPECT_EQ(job.number, 3U);
  DirectionRanges echoes{256, 64, std::vector<float>(job.directions.count()),
                         std::vector<float>(job.directions.count())};
  echoes.range_m[300] = 6.0F;
  echoes.intensity[300] = 1e-7F;  // a strength of 1000: 100 log10(1000 / 30) = 152
  echoes.range_m[301] = 6.0F;
  echoes.intensity[301] = 1e-13F;  // below the threshold
  const DirectionRanges sent = shots->measured(echoes);
  EXPECT_NEAR(static_cast<double>(sent.range_m[300]), 6.0 * 1491 / 1500, 0.002);
  EXPECT_EQ(sent.intensity[300], 152.0F);
  EXPECT_EQ(sent.range_m[301], 0.0F);
  EXPECT_EQ(sent.intensity[301], 0.0F);
  const PingRecord record = shots->record_of_measured(3, sent, 1'767'225'600'250'000'000);
  EXPECT_EQ(record.number, 3U);
  EXPECT_EQ(record.settings.beams, 256);
  const auto shot = sonar3d15::recorded_form(record.wire);
  ASSERT_TRUE(shot.has_value());
  EXPECT_EQ(static_cast<float>(sonar3d15::distance_m(shot->range, 300)), sent.range_m[300]);
  EXPECT_EQ(static_cast<std::uint8_t>(shot->signal.image_pixel_data()[300]), 152);
  EXPECT_EQ(shot->range.header().sequence_id(), 3U);
  EXPECT_EQ(shot->range.header().timestamp().nanos(), 250'000'000);
}

TEST(Sonar3d15Survey, RefusesOptionsOfOtherHeads) {
  SurveyOptions options;
  options.gain_percent = 10;
  EXPECT_THROW(survey(options), CLI::ValidationError);
  options = {};
  options.range_m = 20;
  EXPECT_THROW(survey(options), CLI::ValidationError);
  options.range_m = 8;
  options.frequency = "high";
  EXPECT_NEAR(survey(options)->job(0).directions.horizontal_fov_rad, 0.698, 0.001);
}

}  // namespace
}  // namespace sonard::server
