// SPDX-License-Identifier: Apache-2.0
// What a client must see (the acceptance list of the protocol's description, from its second item on; items 1
// and 3 are tests of the codec).
#include <numbers>

#include "tests/unit/protocol/dvl_a50/device/bench.hpp"

namespace sonard::dvl_a50 {
namespace {

// ---- 2: commands in any pieces

TEST(DvlCommands, GluedTogetherAreAnsweredInOrder) {
  Bench bench;
  bench.say(R"({"command":"get_config"}{"command": "get_version_info"})"
            "\r\n   "
            R"( {"command":"x{}\"}", "parameters": {"a":{"b":"}}"}}})");
  ASSERT_EQ(bench.responses.size(), 3U);
  EXPECT_EQ(bench.responses[0].report.command, "get_config");
  EXPECT_EQ(bench.responses[1].report.command, "get_version_info");
  EXPECT_EQ(bench.responses[2].report.command, "x{}\"}");
  EXPECT_FALSE(bench.responses[2].report.success);
}

TEST(DvlCommands, SplitInTheMiddleOfAWordAreWhole) {
  Bench bench;
  const std::string text = command_text("get_config");
  for (const char c : text) {
    EXPECT_TRUE(bench.responses.empty());
    bench.say(std::string(1, c));
  }
  ASSERT_EQ(bench.responses.size(), 1U);
  EXPECT_TRUE(bench.responses[0].report.success);
}

TEST(DvlCommands, TextThatIsNoCommandIsNotAnsweredAndClosesNothing) {
  Bench bench;
  bench.say("hello\r\n{]}[1]{\"a\":1}");
  EXPECT_TRUE(bench.responses.empty());
  EXPECT_TRUE(bench.last.disconnect.empty());
  EXPECT_EQ(bench.device.counters().unreadable, 2U);
  EXPECT_TRUE(bench.ask("get_config").success);
}

TEST(DvlCommands, AnObjectWithoutAnEndDisconnectsItsClient) {
  Bench bench;
  bench.say("{\"a\":\"" + std::string(70'000, 'x'));
  EXPECT_EQ(bench.last.disconnect, std::vector{client_a});
  EXPECT_EQ(bench.device.counters().overflows, 1U);
}

TEST(DvlCommands, OnlyTheAskerHearsTheResponse) {
  Bench bench;
  bench.step(ClientCame{client_b});
  bench.ask("get_config", {}, client_b);
  EXPECT_NE(bench.heard[std::pair(0, client_b.remote.port)].find("response_to"), std::string::npos);
  EXPECT_EQ(bench.heard[std::pair(0, client_a.remote.port)].find("response_to"), std::string::npos);
}

// ---- 4: rates

/// The mean time between reports, milliseconds, of 8 s at a height, after 3 s.
double spacing_ms(Bench& bench, double height_m) {
  bench.height_m = height_m;
  bench.run_for(3s);
  const std::size_t before = bench.velocities.size();
  bench.run_for(8s);
  const auto span = bench.velocities.back().time - bench.velocities[before].time;
  return 1e-6 * static_cast<double>(span.count()) / static_cast<double>(bench.velocities.size() - 1 - before);
}

TEST(DvlRates, FollowTheAltitude) {
  DeviceConfig config = quiet();
  config.settings.periodic_cycling_enabled = false;
  Bench bench(config);
  EXPECT_NEAR(spacing_ms(bench, 0.2), 1000 / 15.0, 0.5);
  EXPECT_NEAR(spacing_ms(bench, 2.0), 100.0, 0.5);
  EXPECT_NEAR(spacing_ms(bench, 10.0), 1000 / 5.3, 0.5);
  EXPECT_NEAR(spacing_ms(bench, 25.0), 1000 / 7.5, 0.5);
  EXPECT_NEAR(spacing_ms(bench, 45.0), 1000 / 3.0, 0.5);
}

TEST(DvlRates, TimeIsTheSpacingOfReports) {
  Bench bench;
  bench.run_for(12s);
  ASSERT_GT(bench.velocities.size(), 50U);
  for (std::size_t i = 1; i < bench.velocities.size(); ++i) {
    const auto span = bench.velocities[i].time - bench.velocities[i - 1].time;
    EXPECT_NEAR(bench.velocities[i].report.since_last_ms, 1e-6 * static_cast<double>(span.count()), 2e-3);
  }
}

TEST(DvlRates, PeriodicCyclingTakesOneReportEveryTenSeconds) {
  for (const bool on : {true, false}) {
    DeviceConfig config = quiet();
    config.settings.periodic_cycling_enabled = on;
    Bench bench(config);
    bench.run_for(41s);
    int gaps = 0;
    for (const auto& [time, report] : bench.velocities) {
      gaps += report.since_last_ms > 150.0 && time > 2s ? 1 : 0;
    }
    EXPECT_EQ(gaps, on ? 4 : 0);
  }
}

TEST(DvlRates, TimesAreThoseOfTheReflectionAndOfTheSending) {
  Bench bench;
  bench.run_for(3s);
  const auto& [time, report] = bench.velocities.back();
  EXPECT_EQ(report.transmission_us, (1767225600s + time) / 1us);
  EXPECT_EQ(report.transmission_us - report.validity_us, 150'000);
  const PingJob* sent = nullptr;
  for (const PingJob& job : bench.jobs) {
    sent = job.transmit_time + 150ms < time ? &job : sent;
  }
  ASSERT_NE(sent, nullptr);
  const std::int64_t left_us = (1767225600s + sent->transmit_time) / 1us;
  EXPECT_NEAR(static_cast<double>(report.validity_us - left_us), 1e6 * report.beams[0].distance_m / 1475,
              2.0);
}

// ---- Measurement

TEST(DvlMeasurement, IsThatOfTheWorkedMessage) {
  Bench bench;
  bench.height_m = 185 * 0.0118 * beam_cosine;
  bench.run_for(3s);
  const Velocity& report = bench.velocities.back().report;
  EXPECT_TRUE(report.valid);
  EXPECT_NEAR(report.velocity_mps[0], 0.5, 1e-12);
  EXPECT_NEAR(report.velocity_mps[1], -0.2, 1e-12);
  EXPECT_NEAR(report.velocity_mps[2], 0.05, 1e-12);
  EXPECT_NEAR(report.altitude_m, 2.001829019472139, 1e-9);
  const double velocities_mps[] = {-0.14322465842560458, -0.03498543839636518, 0.2356126116767333,
                                   0.1273733916474939};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(report.beams.at(i).velocity_mps, velocities_mps[i], 1e-8) << i;
    EXPECT_NEAR(report.beams.at(i).distance_m, 2.183, 1e-12);
    EXPECT_NEAR(report.beams.at(i).rssi_dbm, -30 - 20 * std::log10(2.183 / 0.5), 1e-9);
  }
}

TEST(DvlMeasurement, ScalesWithTheSpeedOfSoundThatIsSet) {
  Bench bench;
  bench.ask("set_config", R"({"speed_of_sound":1622.5})");
  bench.run_for(3s);
  const Velocity& report = bench.velocities.back().report;
  EXPECT_NEAR(report.velocity_mps[0], 0.5 * 1.1, 1e-9);
  EXPECT_NEAR(report.beams[0].distance_m, 1.1 * 2.0 / beam_cosine, 0.007);
}

TEST(DvlMeasurement, NoiseGrowsWithTheSpeedAndIsThatOfTheCovariance) {
  DeviceConfig config = quiet();
  config.beam_noise_mps = 1e-3;
  config.beam_noise_factor = 1e-2;
  for (const double speed_mps : {0.0, 1.0}) {
    Bench bench(config);
    bench.move(moving({speed_mps, 0.0, 0.0}));
    bench.run_for(120s);
    double squares = 0.0;
    for (const auto& [time, report] : bench.velocities) {
      squares += std::pow(report.velocity_mps[0] - speed_mps, 2);
    }
    const double variance = squares / static_cast<double>(bench.velocities.size());
    const double expected = (2 + std::sqrt(2)) * std::pow(1e-3 + 1e-2 * speed_mps, 2);
    EXPECT_NEAR(variance / expected, 1.0, 0.15);
    EXPECT_NEAR(bench.velocities.back().report.covariance[0][0] / expected, 1.0, 1e-6);
    EXPECT_NEAR(bench.velocities.back().report.fom_mps, std::sqrt(expected), 1e-9);
  }
}

TEST(DvlMeasurement, ADeviceThatIsTooFastHasNoBottomLock) {
  Bench bench;
  bench.move(moving({3.7, 0, 0}));
  bench.run_for(3s);
  EXPECT_TRUE(bench.velocities.back().report.valid);
  bench.move(moving({3.8, 0, 0}));
  bench.run_for(3s);
  EXPECT_FALSE(bench.velocities.back().report.valid);
}

// ---- 5, 6: no bottom, blocked beams

TEST(DvlBottom, LostAndFoundAgain) {
  Bench bench;
  bench.run_for(3s);
  EXPECT_TRUE(bench.velocities.back().report.valid);
  bench.height_m = 0.0;
  bench.run_for(5s);
  const Velocity lost = bench.velocities.back().report;
  EXPECT_FALSE(lost.valid);
  EXPECT_EQ(lost.velocity_mps, Vector{});
  EXPECT_EQ(lost.altitude_m, -1.0);
  EXPECT_EQ(lost.fom_mps, 2.707);
  EXPECT_NEAR(lost.since_last_ms, 1100.0, 1.0);
  for (const Beam& beam : lost.beams) {
    EXPECT_FALSE(beam.valid);
    EXPECT_EQ(beam.distance_m, -1.0);
    EXPECT_EQ(beam.velocity_mps, 0.0);
    EXPECT_NE(beam.rssi_dbm, 0.0);
    EXPECT_NE(beam.nsd_dbm, 0.0);
  }
  bench.height_m = 2.0;
  bench.run_for(1400ms);
  EXPECT_TRUE(bench.velocities.back().report.valid);
  EXPECT_NEAR(bench.velocities.back().report.since_last_ms, 100.0, 20.0);
}

TEST(DvlBottom, OutsideOfTheModesThatAreAllowedThereIsNoLock) {
  Bench bench;
  bench.ask("set_config", R"({"range_mode":"=3"})");
  bench.run_for(5s);
  EXPECT_FALSE(bench.velocities.back().report.valid);
  bench.height_m = 20.0;
  bench.run_for(3s);
  EXPECT_TRUE(bench.velocities.back().report.valid);
}

TEST(DvlBottom, OneBeamBlockedIsValidAndTwoAreNot) {
  Bench bench;
  for (std::size_t beam = 0; beam < 4; ++beam) {
    bench.blocked = {};
    bench.blocked.at(beam) = true;
    bench.run_for(3s);
    const Velocity report = bench.velocities.back().report;
    EXPECT_TRUE(report.valid);
    EXPECT_FALSE(report.beams.at(beam).valid);
    EXPECT_NEAR(report.velocity_mps[0], 0.5, 1e-9);
    EXPECT_NEAR(report.altitude_m, 2.0 - 0.015, 0.006);
    bench.blocked.at((beam + 1) % 4) = true;
    bench.run_for(3s);
    EXPECT_FALSE(bench.velocities.back().report.valid);
  }
}

// ---- 7: settings

TEST(DvlSettings, EachAloneAndAllTogether) {
  Bench bench;
  for (const char* const one : {R"("speed_of_sound":1500)", R"("acoustic_enabled":false)",
                                R"("dark_mode_enabled":true)", R"("mounting_rotation_offset":20.5)",
                                R"("range_mode":"1<=3")", R"("periodic_cycling_enabled":false)"}) {
    EXPECT_TRUE(bench.ask("set_config", "{" + std::string(one) + "}").success) << one;
  }
  const auto config = [&] { return bench.ask("get_config").result; };
  EXPECT_EQ(*config().find("speed_of_sound")->as<double>(), 1500.0);
  EXPECT_EQ(*config().find("acoustic_enabled")->as<bool>(), false);
  EXPECT_EQ(*config().find("dark_mode_enabled")->as<bool>(), true);
  EXPECT_EQ(*config().find("mounting_rotation_offset")->as<double>(), 20.5);
  EXPECT_EQ(*config().find("range_mode")->as<std::string>(), "1<=3");
  EXPECT_EQ(*config().find("periodic_cycling_enabled")->as<bool>(), false);
  EXPECT_TRUE(
      bench
          .ask("set_config", R"({"speed_of_sound":1475,"acoustic_enabled":true,"dark_mode_enabled":false,
      "mounting_rotation_offset":0,"range_mode":"auto","periodic_cycling_enabled":true})")
          .success);
  EXPECT_EQ(*config().find("speed_of_sound")->as<double>(), 1475.0);
  EXPECT_EQ(*config().find("range_mode")->as<std::string>(), "auto");
}

TEST(DvlSettings, AWrongValueIsNamedAndChangesNothing) {
  Bench bench;
  const std::pair<const char*, const char*> cases[] = {
      {"speed_of_sound", "999.9"},        {"speed_of_sound", "2000.1"},
      {"speed_of_sound", "\"1500\""},     {"acoustic_enabled", "1"},
      {"mounting_rotation_offset", "-1"}, {"mounting_rotation_offset", "361"},
      {"range_mode", "\"=5\""},           {"range_mode", "3"},
      {"periodic_cycling_enabled", "0"},  {"volume", "11"}};
  for (const auto& [name, value] : cases) {
    const auto response =
        bench.ask("set_config", std::string(R"({"dark_mode_enabled":true,")") + name + "\":" + value + "}");
    EXPECT_FALSE(response.success) << name;
    EXPECT_EQ(response.error, "invalid value for " + std::string(name));
  }
  EXPECT_FALSE(*bench.ask("get_config").result.find("dark_mode_enabled")->as<bool>());
  EXPECT_EQ(bench.device.counters().refused, std::size(cases));
}

// ---- 8: triggers

TEST(DvlTriggers, EachGivesOneReportAndTheSixteenthIsRefused) {
  Bench bench;
  EXPECT_FALSE(bench.ask("trigger_ping").success) << "acoustics are on";
  bench.ask("set_config", R"({"acoustic_enabled":false})");
  bench.run_for(2s);
  const std::size_t before = bench.velocities.size();
  const std::size_t positions = bench.positions.size();
  bench.run_for(5s);
  EXPECT_EQ(bench.velocities.size(), before) << "silence";
  EXPECT_NEAR(static_cast<double>(bench.positions.size() - positions), 25.0, 1.0);
  bench.renderer_answers = false;
  EXPECT_TRUE(bench.ask("trigger_ping").success);
  for (int i = 0; i < 15; ++i) {
    EXPECT_TRUE(bench.ask("trigger_ping").success) << i;
  }
  EXPECT_FALSE(bench.ask("trigger_ping").success);
  bench.renderer_answers = true;
  bench.answer(bench.image_of(bench.jobs.back()));
  bench.run_for(10s);
  EXPECT_EQ(bench.velocities.size(), before + 16);
}

// ---- 9, 10: mounting, water tracking

TEST(DvlMounting, ForwardMotionOfTheVehicleIsVxWhateverTheOffset) {
  for (const double offset_deg : {0.0, 90.0, 200.0}) {
    Bench bench;
    bench.ask("set_config", "{\"mounting_rotation_offset\":" + std::to_string(offset_deg) + "}");
    const double rad = offset_deg * std::numbers::pi / 180.0;
    bench.move(moving({std::cos(rad), -std::sin(rad), 0.0}));
    bench.run_for(3s);
    const Velocity& report = bench.velocities.back().report;
    EXPECT_NEAR(report.velocity_mps[0], 1.0, 1e-9);
    EXPECT_NEAR(report.velocity_mps[1], 0.0, 1e-9);
  }
}

TEST(DvlWaterTracking, ReportsTheMotionThroughTheWaterTwiceASecondWithoutAnAltitude) {
  DeviceConfig config = quiet();
  config.water_current_mps = {0.0, 0.25, 0.0};  // to the north, where the vehicle goes
  config.settings.range_mode = "wt";
  Bench bench(config);
  bench.height_m = 30.0;
  bench.run_for(5s);
  const Velocity& report = bench.velocities.back().report;
  EXPECT_TRUE(report.of_water);
  EXPECT_TRUE(report.valid);
  EXPECT_NEAR(report.velocity_mps[0], 0.25, 1e-9);
  EXPECT_NEAR(report.velocity_mps[1], -0.2, 1e-9);
  EXPECT_NEAR(report.since_last_ms, 500.0, 1.0);
  EXPECT_EQ(bench.heard[std::pair(0, client_a.remote.port)].find("altitude"), std::string::npos);
  EXPECT_TRUE(bench.ask("set_config", R"({"range_mode":"auto"})").success);
  bench.run_for(3s);
  EXPECT_FALSE(bench.velocities.back().report.of_water);
  EXPECT_TRUE(bench.ask("set_config", R"({"range_mode":"wt"})").success);
  bench.height_m = 1.0;
  bench.run_for(2s);
  EXPECT_FALSE(bench.velocities.back().report.valid) << "the bottom is in front of the layer";
}

// ---- 11: clients

TEST(DvlClients, EachHasItsStreamAndOneThatGoesTakesNoneOfTheOthers) {
  Bench bench;
  bench.height_m = 0.3;
  bench.step(ClientCame{client_b});
  bench.step(ClientCame{pd6_client});
  bench.step(ClientCame{pd4_client});
  bench.run_for(3s);
  EXPECT_EQ(bench.heard[std::pair(0, client_a.remote.port)], bench.heard[std::pair(0, client_b.remote.port)]);
  EXPECT_NE(bench.heard[std::pair(1, pd6_client.remote.port)].find(":BI,  +500,  -200,   +50,    +0,A\r\n"),
            std::string::npos);
  EXPECT_EQ(bench.heard[std::pair(2, pd4_client.remote.port)].size(), 47 * bench.velocities.size());
  bench.say("{\"command\":", client_b);
  bench.step(ClientGone{client_b});
  const std::size_t before = bench.velocities.size();
  bench.run_for(4s);
  EXPECT_NEAR(static_cast<double>(bench.velocities.size() - before), 60.0, 1.0);
}

TEST(DvlClients, NobodyMeansNoPing) {
  Bench bench;
  bench.step(ClientGone{client_a});
  EXPECT_TRUE(bench.last.nobody_there);
  const std::size_t before = bench.jobs.size();
  bench.run_for(3s);
  EXPECT_EQ(bench.jobs.size(), before);
  bench.step(ClientCame{http_client});
  EXPECT_TRUE(bench.last.nobody_there);
  bench.step(ClientCame{pd6_client});
  EXPECT_EQ(bench.jobs.size(), before + 1);
}

// ---- 12: HTTP

std::string page(const std::string& path) {
  Bench bench;
  bench.step(ClientCame{http_client});
  bench.say("GET " + path + " HTTP/1.1\r\nHost: dvl\r\n", http_client);
  EXPECT_TRUE(bench.heard[std::pair(3, http_client.remote.port)].empty()) << "the request is not complete";
  bench.say("\r\n", http_client);
  EXPECT_EQ(bench.last.disconnect, std::vector{http_client});
  return bench.heard[std::pair(3, http_client.remote.port)];
}

TEST(DvlHttp, AboutStatusAndNothingElse) {
  EXPECT_NE(page("/api/v1/about").find(R"("product_name":"DVL A50")"), std::string::npos);
  EXPECT_NE(page("/api/v1/about/status").find("\r\n\r\n{\"temperature\":30.0}"), std::string::npos);
  EXPECT_TRUE(page("/").starts_with("HTTP/1.1 200 "));
  EXPECT_TRUE(page("/api/v1/other").starts_with("HTTP/1.1 404 "));
}

TEST(DvlHttp, ARequestWithoutAnEndIsRefused) {
  Bench bench;
  bench.step(ClientCame{http_client});
  bench.say("GET /" + std::string(9000, 'x'), http_client);
  EXPECT_TRUE(bench.heard[std::pair(3, http_client.remote.port)].starts_with("HTTP/1.1 400 "));
  EXPECT_EQ(bench.last.disconnect, std::vector{http_client});
}

// ---- Time and releases

TEST(DvlTime, IsSetByHandUnlessAServerSetsIt) {
  Bench bench;
  EXPECT_TRUE(bench.ask("set_time_manual", R"({"now":"2019-05-04T03:02:01Z"})").success);
  const Json status = bench.ask("get_time_status").result;
  EXPECT_EQ(*status.find("system_time")->as<std::string>(), "2019-05-04T03:02:01.000000Z");
  EXPECT_FALSE(*status.find("ntp_synced")->as<bool>());
  EXPECT_NE(status.find("ntp_seconds_since_last_sync")->as<std::nullptr_t>(), nullptr);
  EXPECT_FALSE(bench.ask("set_time_manual", R"({"now":"soon"})").success);
  EXPECT_TRUE(bench.ask("set_time_ntp", R"({"ntp_address":"192.168.2.2"})").success);
  EXPECT_EQ(*bench.ask("get_time_ntp").result.find("ntp_address")->as<std::string>(), "192.168.2.2");

  DeviceConfig config = quiet();
  config.ntp_synced = true;
  Bench synced(config);
  EXPECT_EQ(synced.ask("set_time_manual", R"({"now":"2019-05-04T03:02:01Z"})").error,
            "Manual time not allowed when NTP is synchronized");
  const Json forced = synced.ask("force_sync_ntp", R"({"timeout_seconds":2})").result;
  EXPECT_EQ(*forced.find("message")->as<std::string>(), "NTP force-sync successful");
  EXPECT_EQ(*forced.find("status")->find("ntp_synced_to")->as<std::string>(), "auto");
}

TEST(DvlTime, AForcedSyncWithoutAServerEndsWithItsTimeout) {
  Bench bench;
  bench.say(command_text("force_sync_ntp", R"({"timeout_seconds":2})"));
  bench.run_for(1900ms);
  EXPECT_TRUE(bench.responses.empty());
  bench.run_for(200ms);
  ASSERT_EQ(bench.responses.size(), 1U);
  EXPECT_TRUE(bench.responses[0].report.success);
  EXPECT_EQ(*bench.responses[0].report.result.find("message")->as<std::string>(),
            "NTP force-sync not successful within timeout");
}

TEST(DvlReleases, AnOlderOneHasFewerCommandsAndAnotherFormat) {
  DeviceConfig config = quiet();
  config.release = Release::v2_4_0;
  Bench bench(config);
  EXPECT_FALSE(bench.ask("get_version_info").success);
  EXPECT_FALSE(bench.ask("set_config", R"({"range_mode":"wt"})").success);
  EXPECT_TRUE(bench.ask("get_config").success);
  EXPECT_NE(bench.heard[std::pair(0, client_a.remote.port)].find("\"format\":\"json_v3.1\""),
            std::string::npos);
}

TEST(DvlCommands, CalibrationAnswersAfterItsTimeWhileReportsGoOn) {
  Bench bench;
  bench.say(command_text("calibrate_gyro"));
  bench.run_for(2900ms);
  EXPECT_TRUE(bench.responses.empty());
  EXPECT_GT(bench.velocities.size(), 10U);
  bench.run_for(200ms);
  ASSERT_EQ(bench.responses.size(), 1U);
  EXPECT_TRUE(bench.responses[0].report.success);
}

}  // namespace
}  // namespace sonard::dvl_a50
