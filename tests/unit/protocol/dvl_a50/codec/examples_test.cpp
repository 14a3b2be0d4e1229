// SPDX-License-Identifier: Apache-2.0
// The messages of tests/data/dvl_a50: values to bytes, and bytes to values.
#include <gtest/gtest.h>

#include <string>

#include "protocol/dvl_a50/client.hpp"
#include "protocol/dvl_a50/codec.hpp"
#include "protocol/dvl_a50/pathfinder.hpp"
#include "protocol/dvl_a50/sentences.hpp"
#include "protocol/dvl_a50/utc.hpp"
#include "tests/support/messages.hpp"

namespace sonard::dvl_a50 {
namespace {

constexpr std::string_view format = "json_v3.3";

std::string text(const std::string& name) {
  const auto bytes = sonard::testing::message_bytes("dvl_a50", name);
  return {bytes.begin(), bytes.end()};
}

/// The worked ping of the protocol's description: v = (0.5, -0.2, 0.05) m/s, 2 m above a flat bottom.
Velocity worked() {
  Velocity report{.since_last_ms = 125.0,
                  .velocity_mps = {0.5, -0.2, 0.05},
                  .fom_mps = 0.001,
                  .covariance = {{{1e-6, 0, 0}, {0, 1e-6, 0}, {0, 0, 1e-7}}},
                  .altitude_m = 2.001829019472139,
                  .beams = {},
                  .valid = true,
                  .validity_us = 1767225600000000,
                  .transmission_us = 1767225600190000};
  const double velocities[] = {-0.14322465842560458, -0.03498543839636518, 0.2356126116767333,
                               0.1273733916474939};
  for (int id = 0; id < 4; ++id) {
    report.beams.at(static_cast<std::size_t>(id)) = {id, velocities[id], 2.183, -40.0, -95.0, true};
  }
  return report;
}

const Position worked_position{1767225600.19, {1.0, 2.0, 0.5}, 0.002, 0.6, -0.3, 10.0, 0};

TEST(DvlExamples, VelocityReport) {
  EXPECT_EQ(encode(worked(), format), text("velocity"));
  EXPECT_EQ(decode_velocity(parse_json(text("velocity")).value()), worked());
}

TEST(DvlExamples, WaterTrackingReportHasNoAltitude) {
  Velocity report = worked();
  report.of_water = true;
  const std::string line = encode(report, format);
  EXPECT_EQ(line.find("altitude"), std::string::npos);
  EXPECT_NE(line.find(R"("type":"velocity_water")"), std::string::npos);
  report.altitude_m = -1.0;
  EXPECT_EQ(decode_velocity(parse_json(line).value()), report);
}

TEST(DvlExamples, PositionReport) {
  EXPECT_EQ(encode(worked_position, format), text("position_local"));
  EXPECT_EQ(decode_position(parse_json(text("position_local")).value()), worked_position);
}

TEST(DvlExamples, Responses) {
  EXPECT_EQ(encode(Response{}, "reset_dead_reckoning", format), text("reset_response"));
  EXPECT_EQ(encode(Response{{}, encode(Settings{}, Release::v2_7_2)}, "get_config", format),
            text("get_config_response"));
}

TEST(DvlExamples, CommandsThatClientsSend) {
  EXPECT_EQ(command_text("get_config"), text("get_config"));
  Settings settings;
  const Json command = parse_json(text("set_config")).value();
  EXPECT_EQ(apply(*command.find("parameters")->as<Json::Members>(), Release::v2_7_2, settings), std::nullopt);
  EXPECT_EQ(settings, (Settings{.speed_of_sound_mps = 1480, .mounting_rotation_offset_deg = 20}));
}

TEST(DvlExamples, EveryChecksumIsThatOfOurCrc8) {
  EXPECT_EQ(crc8("123456789"), 0xF4);
  int sentences = 0;
  for (const std::string& name : sonard::testing::message_names("dvl_a50")) {
    const std::string line = text(name);
    if (const std::size_t star = line.find('*'); line.starts_with('w')) {
      EXPECT_EQ(with_checksum(line.substr(0, star)), line);
      ++sentences;
    }
  }
  EXPECT_EQ(sentences, 26);
}

TEST(DvlExamples, Sentences) {
  EXPECT_EQ(velocity_sentence(worked()), text("wrz"));
  for (const Beam& beam : worked().beams) {
    EXPECT_EQ(beam_sentence(beam), text("wru_" + std::to_string(beam.id)));
  }
  EXPECT_EQ(position_sentence(worked_position), text("wrp"));
  EXPECT_EQ(with_checksum(settings_text({})), text("wrc"));
}

TEST(DvlExamples, DocumentedSentences) {
  Velocity report{.since_last_ms = 123.0,
                  .velocity_mps = {0.12, -0.4, 2.0},
                  .fom_mps = 1.855,
                  .covariance = {{{1e-7, 0, 1.4}, {0, 1.2, 0}, {0.2, 0, 1e9}}},
                  .altitude_m = 1.3,
                  .beams = {},
                  .valid = true,
                  .status = 1,
                  .validity_us = 7,
                  .transmission_us = 14};
  EXPECT_EQ(velocity_sentence(report), text("documented_wrz"));
  report.of_water = true;
  EXPECT_EQ(velocity_sentence(report), text("documented_wrs"));
  EXPECT_EQ(beam_sentence({0, 0.07, 1.1, -40, -95, true}), text("documented_wru"));
  EXPECT_EQ(position_sentence({49056.809, {0.41, 0.15, 1.23}, 0.4, 53.9, 13.0, 19.3, 0}),
            text("documented_wrp"));
  report = {
      .since_last_ms = 112.83, .velocity_mps = {0.007, 0.017, 0.006}, .altitude_m = 0.93, .valid = true};
  EXPECT_EQ(old_velocity_sentence(report), text("documented_wrx"));
  report = {.since_last_ms = 1075.51, .fom_mps = 2.707, .status = 1};
  EXPECT_EQ(old_velocity_sentence(report), text("documented_wrx_invalid"));
  const double distances_m[] = {14.9, 15.1, 14.8, -1.0};
  for (std::size_t i = 0; i < 4; ++i) {
    report.beams.at(i).distance_m = distances_m[i];
  }
  EXPECT_EQ(old_distance_sentence(report), text("documented_wrt"));
}

TEST(DvlExamples, SerialCommands) {
  const auto command = parse_command(text("wcs_sound_speed"));
  ASSERT_TRUE(command && command->checked);
  EXPECT_EQ(command->name, "wcs");
  Settings settings;
  EXPECT_TRUE(apply(command->options, settings));
  EXPECT_EQ(settings, (Settings{.speed_of_sound_mps = 1450, .acoustic_enabled = false}));
  EXPECT_FALSE(parse_command("wcv*ff")->checked);
  EXPECT_TRUE(parse_command("wcv")->checked) << "the checksum is optional";
  EXPECT_FALSE(parse_command("wrv*00"));
  EXPECT_FALSE(apply({"1450", "", ""}, settings)) << "too few";
  EXPECT_FALSE(apply({"fast", "", "", ""}, settings));
  EXPECT_EQ(settings.speed_of_sound_mps, 1450);
}

TEST(DvlExamples, Pd6) {
  Velocity report{.velocity_mps = {0.123, -0.42, 2.0}, .altitude_m = 5.32, .valid = true};
  report.validity_us = parse_rfc3339("2022-02-08T12:06:18Z").value();
  EXPECT_EQ(encode_pd6(report, 1475.0, Release::v2_7_2), text("pd6"));
}

TEST(DvlExamples, Pd4) {
  Velocity report = worked();
  report.validity_us = parse_rfc3339("2022-02-08T12:06:18Z").value();
  EXPECT_EQ(encode_pd4(report, 1475.0), sonard::testing::message_bytes("dvl_a50", "pd4"));
  report.valid = false;
  EXPECT_EQ(encode_pd4(report, 1475.0), sonard::testing::message_bytes("dvl_a50", "pd4_without_lock"));
}

// Each beam has its own place in PD4: transducers 3, 1, 4, 2.
TEST(DvlExamples, Pd4OrdersTheBeamsByTransducer) {
  Velocity report{.valid = true};
  for (std::size_t i = 0; i < 4; ++i) {
    report.beams.at(i).distance_m = 0.01 * static_cast<double>(i + 1);
  }
  const auto bytes = encode_pd4(report, 1475.0);
  EXPECT_EQ((std::vector{bytes[13], bytes[15], bytes[17], bytes[19]}),
            (std::vector<std::uint8_t>{3, 1, 4, 2}));
}

}  // namespace
}  // namespace sonard::dvl_a50
