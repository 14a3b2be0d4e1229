// SPDX-License-Identifier: Apache-2.0
// The pings that `sonard render` makes for its options, and the options that a Ping1D refuses.
#include "server/devices/ping1d/survey.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/Error.hpp>

#include "protocol/ping1d/recorded_form.hpp"
#include "server/devices/ping1d/type.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;

std::unique_ptr<Survey> survey(const SurveyOptions& options) {
  return ping1d_type().survey(ping1d_type().make_default(), options);
}

TEST(Ping1dSurvey, EachPingIsAFrameOfTheSamples) {
  SurveyOptions options;
  options.range_m = 20.0;
  options.gain_percent = 100.0;
  const std::unique_ptr<Survey> pings = survey(options);
  EXPECT_THAT(pings->frames(3), ElementsAre(0, 1, 2, 3));
  const PingJob job = pings->job(2);
  EXPECT_EQ(job.number, 2U);
  EXPECT_EQ(job.bins(), 2000);
  EXPECT_NEAR(job.range_m(), 20.0, 1e-9);
  EXPECT_NEAR(pings->client_bin_m(), 0.01, 1e-12);
  EXPECT_FALSE(job.sixteen_bit);
  EXPECT_EQ(job.gain_percent, 100.0);
  EXPECT_EQ(pings->natural_period(), std::chrono::milliseconds(250));
}

TEST(Ping1dSurvey, ARecordHasProfileAndDistance) {
  SurveyOptions options;
  options.range_m = 10.0;
  const std::unique_ptr<Survey> pings = survey(options);
  std::vector<std::uint8_t> samples(2000);
  std::fill(samples.begin() + 800, samples.begin() + 830, 200);
  const PingRecord record = pings->record(4, samples);
  EXPECT_EQ(record.number, 4U);
  EXPECT_EQ(record.settings.bins, 200);
  EXPECT_EQ(record.samples.size(), 200U);
  const auto measured = ping1d::recorded_form(record.wire);
  ASSERT_TRUE(measured);
  EXPECT_EQ(measured->distance_mm, 4000U);
  EXPECT_EQ(measured->scan_length_mm, 10'000U);
}

TEST(Ping1dSurvey, OptionsOfOtherHeadsAreRefused) {
  SurveyOptions options;
  options.step_deg = 1.0;
  EXPECT_THROW(survey(options), CLI::ValidationError);
  options = {};
  options.range_m = 500.0;
  EXPECT_THROW(survey(options), CLI::ValidationError);
}

}  // namespace
}  // namespace sonard::server
