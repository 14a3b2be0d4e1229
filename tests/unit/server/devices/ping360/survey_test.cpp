// SPDX-License-Identifier: Apache-2.0
// The scan that `sonard render` makes for its options, and the options that a Ping360 refuses.
#include "server/devices/ping360/survey.hpp"

#include <type_traits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/Error.hpp>

#include "server/devices/ping360/type.hpp"
#include "tests/support/degree.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::unique_ptr<Survey> survey(const SurveyOptions& options) {
  return ping360_type().survey(ping360_type().make_default(), options);
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

// protocol/ping360/README.md 2.3: 20 m at 1500 m/s are 1200 samples of 888 ticks. 3.7: a ping with a step of
// one gradian takes 1200 * 888 * 25 ns + 18 ms + 6.1 ms.
TEST(Ping360Survey, SamplesAndTimesAreThoseOfClientsAndOfTheHead) {
  const std::unique_ptr<Survey> all_round =
      survey(with(&SurveyOptions::range_m, 20.0, with(&SurveyOptions::gain_percent, 100.0)));
  EXPECT_NEAR(all_round->client_bin_m(), 888 * 25e-9 * 750.0, 1e-12);
  EXPECT_EQ(all_round->natural_period(), std::chrono::nanoseconds(26'640'000 + 18'000'000 + 6'100'000));
  const std::vector<int> frames = all_round->frames(1000);
  EXPECT_THAT(frames, ElementsAre(0, 400, 800));
  EXPECT_THAT(all_round->frames(800), ElementsAre(0, 400, 800)) << "no ping is wanted behind the last turn";
  const PingJob job = all_round->job(100);
  EXPECT_EQ(job.number, 100U);
  EXPECT_EQ(job.bins(), 1200);
  EXPECT_NEAR(job.bearing_rad, 90.0 * degree, 1e-12);
  EXPECT_EQ(job.gain_percent, 100.0);
  EXPECT_NEAR(all_round->sector().width_rad, 360.0 * degree, 1e-12);
}

TEST(Ping360Survey, ASectorIsSweptToAndFro) {
  const std::unique_ptr<Survey> sector =
      survey(with(&SurveyOptions::step_deg, 9.0, with(&SurveyOptions::sector_deg, {-45.0, 45.0})));
  EXPECT_NEAR(sector->sector().left_rad, -45.0 * degree, 1e-12);
  EXPECT_NEAR(sector->sector().width_rad, 90.0 * degree, 1e-12);
  const std::vector<int> frames = sector->frames(32);
  EXPECT_THAT(frames, ElementsAre(0, 11, 21, 31)) << "the ends are not doubled";
  EXPECT_THAT(sector->frames(31), ElementsAre(0, 11, 21, 31));
  EXPECT_NEAR(sector->job(0).bearing_rad, -45.0 * degree, 1e-12);
  EXPECT_NEAR(sector->job(10).bearing_rad, 45.0 * degree, 1e-12);
  EXPECT_NEAR(sector->job(11).bearing_rad, 36.0 * degree, 1e-12);
}

// 3.3: the head takes the short way back to the start, which continues in the same direction.
TEST(Ping360Survey, ASectorOfMoreThanHalfATurnIsScannedOneWay) {
  const std::unique_ptr<Survey> sector =
      survey(with(&SurveyOptions::step_deg, 9.0, with(&SurveyOptions::sector_deg, {-135.0, 135.0})));
  const std::vector<int> frames = sector->frames(70);
  EXPECT_THAT(frames, ElementsAre(0, 31, 62));
  EXPECT_THAT(sector->frames(62), ElementsAre(0, 31, 62));
  EXPECT_NEAR(sector->job(30).bearing_rad, 135.0 * degree, 1e-12);
  EXPECT_NEAR(sector->job(31).bearing_rad, -135.0 * degree, 1e-12);
  EXPECT_NEAR(sector->sector().width_rad, 270.0 * degree, 1e-12);
}

TEST(Ping360Survey, RefusesWhatItDoesNotKnowOrCannotDo) {
  EXPECT_THAT(complaint(with(&SurveyOptions::compression_log2, 1)), HasSubstr("--compression"));
  EXPECT_THAT(complaint(with(&SurveyOptions::bits, 4)), HasSubstr("--bits"));
  EXPECT_THAT(complaint(with(&SurveyOptions::range_m, 0.1)), HasSubstr("--range"));
  EXPECT_THAT(complaint(with(&SurveyOptions::bins, 1201)), HasSubstr("expected 200 to 1200"));
  EXPECT_THAT(complaint(with(&SurveyOptions::range_m, 1.0, with(&SurveyOptions::bins, 1200))),
              HasSubstr("too fine"));
  EXPECT_THAT(complaint(with(&SurveyOptions::step_deg, 1.0)), HasSubstr("multiple of 0.9 degrees"));
  EXPECT_THAT(complaint(with(&SurveyOptions::step_deg, 9.9)), HasSubstr("9 at most"));
  EXPECT_THAT(complaint(with(&SurveyOptions::sector_deg, {10.0, 370.0})), HasSubstr("are equal"));
}

}  // namespace
}  // namespace sonard::server
