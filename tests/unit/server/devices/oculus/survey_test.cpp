// SPDX-License-Identifier: Apache-2.0
// The pings that `sonard render` makes for its options, and the options that an Oculus refuses.
#include "server/devices/oculus/survey.hpp"

#include <numbers>
#include <type_traits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/Error.hpp>

#include "server/devices/oculus/config.hpp"
#include "server/devices/oculus/type.hpp"

namespace sonard::server {
namespace {

using testing::HasSubstr;

std::unique_ptr<Survey> survey(const SurveyOptions& options) {
  return oculus_type().survey(oculus_type().make_default(), options);
}

template <class Value>
SurveyOptions with(Value SurveyOptions::*option, const std::type_identity_t<Value>& value,
                   SurveyOptions options = {}) {
  options.*option = value;
  return options;
}

std::string complaint(const SurveyOptions& options) {
  try {
    survey(options);
    return "";
  } catch (const CLI::ValidationError& error) {
    return error.what();
  }
}

// protocol/oculus/README.md 3.3 and 4.6.
TEST(OculusSurvey, PingsAreThoseOfAClient) {
  const std::unique_ptr<Survey> pings = survey(with(&SurveyOptions::range_m, 40.0));
  EXPECT_NEAR(pings->client_bin_m(), 12 * 1500.0 / (2 * 37.5e6 / 143), 1e-12);
  EXPECT_NEAR(static_cast<double>(pings->natural_period().count()), (2 * 40.0 / 1500.0 + 0.005) * 1e9, 10.0);
  EXPECT_EQ(pings->frames(3), (std::vector<int>{0, 1, 2, 3}));
  const PingJob job = pings->job(2);
  EXPECT_EQ(job.number, 2U);
  EXPECT_EQ(job.beams, 512);
  EXPECT_EQ(job.mode, 0);
  EXPECT_EQ(job.amplitude_exponent, 1.0);
  EXPECT_FALSE(job.sixteen_bit);
  EXPECT_EQ(pings->bearings_rad().size(), 512U);
  EXPECT_NEAR(pings->bearings_rad().front(), -65.0 * std::numbers::pi / 180, 1e-12);
  EXPECT_TRUE(survey(with(&SurveyOptions::bits, 16))->job(0).sixteen_bit);
}

TEST(OculusSurvey, AHeadWithOneFrequencyRefusesTheOther) {
  HeadConfig head = oculus_type().make_default();
  auto config = std::make_shared<OculusConfig>(device_settings<OculusConfig>(head));
  config->device.plan.model = oculus::m370s;
  head.device = config;
  EXPECT_EQ(oculus_type().survey(head, {})->record(0, {}).settings.frequency_hz, 375e3);
  try {
    oculus_type().survey(head, with(&SurveyOptions::frequency, "high"));
    ADD_FAILURE() << "not refused";
  } catch (const CLI::ValidationError& error) {
    EXPECT_STREQ(error.what(), "--frequency: this Oculus has one frequency");
  }
}

TEST(OculusSurvey, RefusesWhatItDoesNotKnowOrCannotDo) {
  EXPECT_THAT(complaint(with(&SurveyOptions::compression_log2, 1)), HasSubstr("--compression"));
  EXPECT_THAT(complaint(with(&SurveyOptions::bins, 500)), HasSubstr("--bins"));
  EXPECT_THAT(complaint(with(&SurveyOptions::step_deg, 1.0)), HasSubstr("--step"));
  EXPECT_THAT(complaint(with(&SurveyOptions::sector_deg, {0.0, 10.0})), HasSubstr("--sector"));
  EXPECT_THAT(complaint(with(&SurveyOptions::range_m, 121.0)), HasSubstr("--range"));
  EXPECT_THAT(complaint(with(&SurveyOptions::gain_percent, 101.0)), HasSubstr("--gain"));
}

}  // namespace
}  // namespace sonard::server
