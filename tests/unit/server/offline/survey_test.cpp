// SPDX-License-Identifier: Apache-2.0
// The pings of each type of device for the options of a survey, and the options that it refuses.
#include <chrono>
#include <memory>
#include <numbers>
#include <string>
#include <type_traits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/Error.hpp>

#include "protocol/gemini/bearings.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/micron/config.hpp"
#include "server/devices/micron/type.hpp"
#include "server/devices/types/types.hpp"

namespace sonard::server {
namespace {

using testing::ElementsAre;

std::unique_ptr<Survey> survey(const DeviceType& type, const SurveyOptions& options = {}) {
  return type.survey(type.make_default(), options);
}

/// Options with one option set.
template <class Value>
SurveyOptions with(Value SurveyOptions::*option, const std::type_identity_t<Value>& value) {
  SurveyOptions options;
  options.*option = value;
  return options;
}

/// The error message for the options, as "--option: problem"; empty if the type accepts them.
std::string complaint(const DeviceType& type, const SurveyOptions& options) {
  try {
    survey(type, options);
    return "";
  } catch (const CLI::ValidationError& error) {
    return error.what();
  }
}

TEST(Survey, EveryKindMakesPingsWithWhatItsClientsHaveAtFirst) {
  for (const DeviceType* type : device_types()) {
    SCOPED_TRACE(type->name());
    const std::unique_ptr<Survey> survey = server::survey(*type);
    EXPECT_GT(survey->natural_period(), std::chrono::nanoseconds{0});
    const std::vector<int> frames = survey->frames(500);
    ASSERT_GE(frames.size(), 2U);
    EXPECT_EQ(frames.front(), 0);
    EXPECT_LE(frames.back(), 500);
    const PingJob job = survey->job(7);
    EXPECT_EQ(job.number, 7U);
    EXPECT_GT(job.bins(), 0);
    EXPECT_GT(job.bin_m(), 0.0);
    EXPECT_GT(job.listening_time, std::chrono::nanoseconds{0});
    EXPECT_TRUE(job.transmit);
    EXPECT_NEAR(survey->client_bin_m(), job.bin_m(), 1e-3 * job.bin_m())
        << "of water as clients take it to be";
    EXPECT_EQ(survey->bearings_rad().empty(), type->scanning());
  }
}

// ---- Gemini

TEST(GeminiSurvey, DoesWhatAClientWouldAskFor) {
  const std::unique_ptr<Survey> plain = survey(gemini_type());
  EXPECT_EQ(plain->job(0).bins(), 2411);  // 20 m
  EXPECT_FALSE(plain->job(0).sixteen_bit);
  EXPECT_EQ(plain->bearings_rad(), gemini::bearings_rad());
  EXPECT_THAT(plain->frames(3), ElementsAre(0, 1, 2, 3));

  SurveyOptions options;
  options.range_m = 4.0;
  options.gain_percent = 80.0;
  options.sound_speed_mps = 1480.0;
  options.compression_log2 = 3;
  options.bits = 16;
  const std::unique_ptr<Survey> asked = survey(gemini_type(), options);
  const PingJob job = asked->job(5);
  EXPECT_EQ(job.compression_log2, 3);
  EXPECT_NEAR(job.range_m(), 4.0, 0.02);
  EXPECT_NEAR(job.gain_percent, 80.0, 1.0);
  EXPECT_TRUE(job.sixteen_bit);
  EXPECT_DOUBLE_EQ(asked->client_bin_m(), 8 * 1480.0 / (2 * 90422.0));
}

TEST(GeminiSurvey, MakesRecordsOfItsPings) {
  SurveyOptions options;
  options.range_m = 1.0;
  options.gain_percent = 30.0;
  const std::unique_ptr<Survey> survey = server::survey(gemini_type(), options);
  const std::vector<std::uint8_t> samples(121U * 256U, 9);
  const PingRecord record = survey->record(6, samples);
  EXPECT_EQ(record.number, 6U);
  EXPECT_EQ(record.samples, samples);
  EXPECT_EQ(record.settings.bins, 121);
  EXPECT_EQ(record.settings.beams, 256);
  EXPECT_DOUBLE_EQ(record.settings.bin_m, 1500.0 / (2 * 90422.0));
  EXPECT_NEAR(record.settings.gain_percent, 30.0, 0.5);
  EXPECT_EQ(record.bearings_rad, gemini::bearings_rad());
}

TEST(Survey, EveryKindMakesRecordsOfItsPings) {
  for (const DeviceType* type : device_types()) {
    SCOPED_TRACE(type->name());
    const std::unique_ptr<Survey> survey = server::survey(*type);
    survey->frames(10);
    const PingJob job = survey->job(3);
    if (job.directions.any()) {  // tested with the device, because its records have no bins of a ping
      continue;
    }
    const std::size_t beams = type->scanning() ? 1 : survey->bearings_rad().size();
    const std::vector<std::uint8_t> samples(static_cast<std::size_t>(job.bins()) * beams, 7);
    const PingRecord record = survey->record(3, samples);
    EXPECT_EQ(record.number, 3U);
    EXPECT_EQ(record.settings.beams, static_cast<int>(beams));
    if (type->name() == "ping1d") {  // sends 200 points of the samples (protocol/ping1d/README.md)
      EXPECT_EQ(record.settings.bins, 200);
      EXPECT_EQ(record.samples, std::vector<std::uint8_t>(200, 7));
      EXPECT_NEAR(200 * record.settings.bin_m, job.range_m(), 1e-3 * job.range_m());
      EXPECT_EQ(record.settings.frequency_hz, 115e3);
    } else {
      EXPECT_EQ(record.samples, samples);
      EXPECT_EQ(record.settings.bins, job.bins());
      EXPECT_NEAR(record.settings.bin_m, job.bin_m(), 1e-3 * job.bin_m());
      if (type->name() != "gemini_720i") {  // a Gemini's pings lack the frequency
        EXPECT_GT(record.settings.frequency_hz, 5e5);
      }
    }
    EXPECT_EQ(record.bearings_rad,
              type->scanning() ? std::vector<double>{job.bearing_rad} : survey->bearings_rad());
  }
}

// protocol/oculus/README.md 2: an M750d has two frequencies, and the fan of the higher one is narrower.
TEST(Survey, AnOculusHasTwoFrequenciesAndOtherHeadsRefuseTheOption) {
  for (const DeviceType* type : device_types()) {
    SCOPED_TRACE(type->name());
    if (type->name() == "sonar3d15") {  // it has two, too: tests/unit/server/devices/sonar3d15
      continue;
    }
    if (type->name() != "oculus") {
      EXPECT_THAT(complaint(*type, with(&SurveyOptions::frequency, "high")),
                  testing::StartsWith("--frequency: not an option for "));
      continue;
    }
    const auto low = survey(*type, with(&SurveyOptions::frequency, "low"));
    const auto high = survey(*type, with(&SurveyOptions::frequency, "high"));
    EXPECT_EQ(survey(*type)->record(0, {}).settings.frequency_hz, low->record(0, {}).settings.frequency_hz);
    EXPECT_GT(high->record(0, {}).settings.frequency_hz, 1.5 * low->record(0, {}).settings.frequency_hz);
    EXPECT_LT(high->bearings_rad().back(), 0.6 * low->bearings_rad().back());
    EXPECT_EQ(high->job(0).mode, 1);
  }
}

TEST(GeminiSurvey, RefusesWhatItDoesNotKnowOrCannotDo) {
  const DeviceType& type = gemini_type();
  EXPECT_EQ(complaint(type, {}), "");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::bins, 400)), "--bins: not an option for Gemini");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::step_deg, 1.8)), "--step: not an option for Gemini");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::sector_deg, {0.0, 90.0})),
            "--sector: not an option for Gemini");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::range_m, 190.0)),
            "--range: 190 is out of range for Gemini (expected 0.3 to 150)");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::range_m, 0.2)),
            "--range: 0.2 is out of range for Gemini (expected 0.3 to 150)");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::sound_speed_mps, 1600.0)),
            "--sound-speed: 1600 is out of range for Gemini (expected 1400 to 1588)");
}

// ---- Micron

TEST(MicronSurvey, DoesWhatAClientWouldAskFor) {
  const std::unique_ptr<Survey> plain = survey(micron_type());
  EXPECT_THAT(plain->frames(401), ElementsAre(0, 200, 400));
  EXPECT_EQ(plain->job(0).bins(), 400);
  EXPECT_NEAR(plain->job(0).range_m(), 10.0, 0.1);
  EXPECT_NEAR(plain->job(50).bearing_rad, std::numbers::pi / 2, 1e-12) << "ahead first, then clockwise";
  const Survey::Sector all_round = plain->sector();
  EXPECT_DOUBLE_EQ(all_round.width_rad, 2 * std::numbers::pi);
  EXPECT_NEAR(all_round.step_rad, 1.8 * std::numbers::pi / 180, 1e-12);

  SurveyOptions options;
  options.range_m = 5.0;
  options.gain_percent = 25.0;
  options.bins = 200;
  options.step_deg = 0.9;
  options.sector_deg = {90.0, -90.0};
  const std::unique_ptr<Survey> asked = survey(micron_type(), options);
  EXPECT_THAT(asked->frames(450), ElementsAre(0, 201, 401)) << "astern, 200 steps";
  EXPECT_EQ(asked->job(0).bins(), 200);
  EXPECT_NEAR(asked->job(0).gain_percent, 25.0, 0.5);
  EXPECT_NEAR(asked->job(0).bearing_rad, std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(asked->job(200).bearing_rad, -std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(asked->job(400).bearing_rad, std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(asked->sector().left_rad, std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(asked->sector().width_rad, std::numbers::pi, 1e-12);
}

TEST(MicronSurvey, AHeadThatIsMountedBootDownLooksToTheOtherSide) {
  HeadConfig head = micron_type().make_default();
  auto config = std::make_shared<MicronConfig>(device_settings<MicronConfig>(head));
  config->device.mounted_inverted = true;
  head.device = config;
  const std::unique_ptr<Survey> survey =
      micron_type().survey(head, with(&SurveyOptions::sector_deg, {-45.0, 90.0}));
  const std::vector<int> frames = survey->frames(100);
  ASSERT_GE(frames.size(), 2U);
  constexpr double eighth = std::numbers::pi / 4;
  EXPECT_NEAR(survey->job(0).bearing_rad, eighth, 1e-12);
  EXPECT_NEAR(survey->job(frames[1] - 1).bearing_rad, -2 * eighth, 1e-12);
  EXPECT_NEAR(survey->sector().left_rad, -2 * eighth, 1e-12);
  EXPECT_NEAR(survey->sector().width_rad, 3 * eighth, 1e-12);
}

TEST(MicronSurvey, RefusesWhatItDoesNotKnowOrCannotDo) {
  const DeviceType& type = micron_type();
  EXPECT_EQ(complaint(type, {}), "");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::compression_log2, 1)),
            "--compression: not an option for Micron");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::bits, 8)), "--bits: not an option for Micron");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::range_m, 201.0)),
            "--range: 201 is out of range for Micron (expected 0.1 to 200)");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::sound_speed_mps, 1200.0)),
            "--sound-speed: 1200 is out of range for Micron (expected 1300 to 1700)");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::bins, 1501)),
            "--bins: 1501 is out of range for Micron (expected 1 to 1500)");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::step_deg, 1.0)),
            "--step: expected a multiple of 0.05625 degrees, 14.34375 at most, found 1");
  EXPECT_EQ(complaint(type, with(&SurveyOptions::sector_deg, {30.0, 30.0})),
            "--sector: FROM and TO are equal; omit --sector to scan all round");
  SurveyOptions too_fine = with(&SurveyOptions::range_m, 0.1);
  too_fine.bins = 1500;
  EXPECT_EQ(complaint(type, too_fine), "--bins: 1500 bins over 0.1 m are too fine for a head");
}

}  // namespace
}  // namespace sonard::server
