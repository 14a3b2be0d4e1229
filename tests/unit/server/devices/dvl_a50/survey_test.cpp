// SPDX-License-Identifier: Apache-2.0
// The pings of a DVL along a trajectory.
#include "server/devices/dvl_a50/survey.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <CLI/Error.hpp>

#include "protocol/dvl_a50/recorded_form.hpp"
#include "server/devices/dvl_a50/type.hpp"

namespace sonard::server {
namespace {

DirectionRanges echoes_at(float range_m) {
  return {16, 16, std::vector<float>(256, range_m), std::vector<float>(256, 1.0F)};
}

TEST(DvlSurvey, KeepsTheFourBeamsOfTheGrid) {
  const auto survey = survey_of_dvl(dvl_a50_type().make_default(), {});
  const DirectionRanges sent = survey->measured(echoes_at(5.0F));
  EXPECT_EQ(std::ranges::count(sent.range_m, 5.0F), 4);
  EXPECT_EQ(std::ranges::count(sent.intensity, 1.0F), 4);
  EXPECT_EQ(sent.range_m.front(), 5.0F);
  EXPECT_EQ(sent.range_m.back(), 5.0F);
}

TEST(DvlSurvey, RecordsTheReportOfADeviceAtRest) {
  const auto survey = survey_of_dvl(dvl_a50_type().make_default(), {});
  const PingRecord record =
      survey->record_of_measured(7, survey->measured(echoes_at(5.0F)), 1'700'000'000'000'000'000);
  EXPECT_EQ(record.number, 7U);
  const auto report = dvl_a50::recorded_form(record.wire);
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->valid);
  EXPECT_NEAR(report->altitude_m, 5.0 * 0.92388 - 0.015, 0.012);
  EXPECT_EQ(report->velocity_mps, (dvl_a50::Vector{}));
  EXPECT_EQ(report->validity_us, 1'700'000'000'000'000);
}

TEST(DvlSurvey, RefusesARange) {
  SurveyOptions options;
  options.range_m = 5.0;
  EXPECT_THROW(survey_of_dvl(dvl_a50_type().make_default(), options), CLI::ValidationError);
}

}  // namespace
}  // namespace sonard::server
