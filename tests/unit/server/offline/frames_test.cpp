// SPDX-License-Identifier: Apache-2.0
// Pings that heads send along a trajectory.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "protocol/npy/npy_file.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/micron/config.hpp"
#include "server/devices/micron/type.hpp"
#include "server/offline/fan_frames.hpp"
#include "server/offline/sweep_frames.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;

using testing::HasSubstr;

constexpr std::int64_t ns_per_s = 1'000'000'000;

/// A trajectory along x from the origin, for `seconds`, beginning at the stamp 100 s.
VehicleTrajectory ahead(int seconds, double speed_mps = 1.0) {
  const std::int64_t start = 100 * ns_per_s;
  return VehicleTrajectory(
      pose::Trajectory({{start, {{0, 0, 0}, {1, 0, 0, 0}}},
                        {start + seconds * ns_per_s, {{speed_mps * seconds, 0, 0}, {1, 0, 0, 0}}}}));
}

/// A Gemini whose device `change` sets up.
template <class Change>
HeadConfig gemini(const Change& change) {
  HeadConfig head = gemini_type().make_default();
  auto config = std::make_shared<GeminiConfig>();
  change(config->device);
  head.device = std::move(config);
  return head;
}

FanFrames fans_of(const HeadConfig& head, const HeadPlace& place, const VehicleTrajectory& trajectory,
                  const OfflineOptions& options) {
  return {head, place, type_of(head).survey(head, options.survey), trajectory, options, nullptr};
}

SweepFrames sweeps_of(const HeadConfig& head, const VehicleTrajectory& trajectory,
                      const OfflineOptions& options) {
  return {head, 0, type_of(head).survey(head, options.survey), trajectory, options, nullptr};
}

TEST(FanFrames, PingAtTheRateAskedForWithNumberAndPose) {
  HeadConfig head = gemini_type().make_default();
  head.T_vehicle_sonar.position_m = {0.5, 0, 0};
  head.seed = 9;
  const VehicleTrajectory trajectory = ahead(2);
  OfflineOptions options;
  options.rate_hz = 4.0;
  const FanFrames frames = fans_of(head, {1, 0}, trajectory, options);
  EXPECT_EQ(frames.count(), 9);
  EXPECT_EQ(frames.name(3), "ping_000003");
  const render::PingRequest ping = frames.request(3);
  EXPECT_EQ(ping.ping_number, 3U);
  EXPECT_EQ(ping.seed, 9U);
  EXPECT_DOUBLE_EQ(ping.T_world_sonar.position_m.x, 0.75 + 0.5);
  // 20 m and back at 1500 m/s take 2411 lines of 1 / 90422 s each.
  ASSERT_TRUE(ping.T_world_sonar_at_end);
  EXPECT_NEAR(ping.T_world_sonar_at_end->position_m.x, 1.25 + 2411 / 90422.0, 1e-8);
  EXPECT_EQ(ping.settings.range.count, 2411);
}

// protocol/gemini/README.md 8.4, 8.5.
TEST(FanFrames, TheNaturalRateIsTheFastestThatHeadWaterAndLinkAllow) {
  HeadConfig head = gemini([](gemini::DeviceConfig& device) { device.min_ping_period = 100ms; });
  const VehicleTrajectory trajectory = ahead(10);
  const auto frames_with = [&](double range_m, int compression_log2) {
    OfflineOptions options;
    options.survey.range_m = range_m;
    options.survey.compression_log2 = compression_log2;
    return fans_of(head, {}, trajectory, options).count();
  };
  EXPECT_EQ(frames_with(20, 0), 101);  // limited by the head
  head = gemini([](gemini::DeviceConfig& device) {
    device.min_ping_period = 1ms;
    device.line_period = 100us;
  });
  EXPECT_EQ(frames_with(20, 0), 1 + static_cast<int>(10.0 / (2413 * 100e-6)));  // limited by the link
  EXPECT_EQ(frames_with(20, 4), 1 + static_cast<int>(10.0 * 90422.0 / 2411));   // limited by the water
}

TEST(FanFrames, RecordsAreThoseOfTheLog) {
  const HeadConfig head = gemini([](gemini::DeviceConfig& device) { device.sonar_id = 777; });
  const VehicleTrajectory trajectory = ahead(1);
  OfflineOptions options;
  options.rate_hz = 2.0;
  options.survey.range_m = 1.0;
  options.survey.gain_percent = 30.0;
  const FanFrames frames = fans_of(head, {0, 2}, trajectory, options);
  EXPECT_TRUE(frames.makes_glf());
  constexpr int lines = 121;  // 1 m of 1500 / 2 / 90422 m
  std::vector<std::uint8_t> pixels(lines * 256U, 7);
  pixels[1] = 200;
  const auto record = frames.record(1, npy::encode({lines, 256, pixels, {}}));
  ASSERT_TRUE(record);
  EXPECT_EQ(record->pixels, pixels);
  EXPECT_EQ(record->lines, 121U);
  EXPECT_EQ(record->origin.device_id, 777);
  EXPECT_EQ(record->origin.node_id, 102);
  EXPECT_DOUBLE_EQ(record->origin.time_s, 100.5);  // the trajectory's own stamp
  EXPECT_DOUBLE_EQ(record->transmit_time_s, 100.5);
  EXPECT_EQ(record->gain_percent, 30);
  EXPECT_GT(record->bearings_rad.front(), 1.0);  // beam 0, to port, is positive in a log
  EXPECT_FALSE(frames.record(1, npy::encode({lines, 255, std::vector<std::uint8_t>(lines * 255U), {}})));
}

TEST(FanFrames, StillsAreOneForEachPoseUnlessARateIsGiven) {
  const HeadConfig head = gemini_type().make_default();
  VehicleTrajectory trajectory = ahead(2);
  trajectory.rest_in_all_pings();
  OfflineOptions options;
  options.still = true;
  const FanFrames frames = fans_of(head, {}, trajectory, options);
  EXPECT_EQ(frames.count(), 2);
  EXPECT_DOUBLE_EQ(frames.request(1).T_world_sonar.position_m.x, 2.0);
  EXPECT_EQ(frames.request(1).T_world_sonar_at_end, frames.request(1).T_world_sonar);
  EXPECT_EQ(frames.settings_json()["still"], true);
  EXPECT_TRUE(frames.settings_json()["period_s"].is_null());
  options.rate_hz = 2.0;
  EXPECT_EQ(fans_of(head, {}, trajectory, options).count(), 5);
}

// 200 lines, 1.8 degrees apart, from each of the two poses.
TEST(SweepFrames, StillsAreAWholeTurnFromEachPose) {
  const HeadConfig head = micron_type().make_default();
  VehicleTrajectory trajectory = ahead(2);
  trajectory.rest_in_all_pings();
  OfflineOptions options;
  options.still = true;
  const SweepFrames frames = sweeps_of(head, trajectory, options);
  EXPECT_EQ(frames.count(), 2);
  EXPECT_EQ(frames.first_line(1), 200);
  EXPECT_EQ(frames.first_line(2), 400);
  for (const int line : {0, 1, 199}) {
    EXPECT_EQ(frames.request(line).T_world_sonar.position_m, glm::dvec3(0.0)) << line;
    EXPECT_EQ(frames.request(200 + line).T_world_sonar.position_m, glm::dvec3(2, 0, 0)) << line;
  }
  EXPECT_EQ(frames.unix_ns(1) - frames.unix_ns(0), 2 * ns_per_s);
}

TEST(SweepFrames, LinesOfALogHaveTheirBearingsTimesAndPoses) {
  const HeadConfig head = micron_type().make_default();
  const VehicleTrajectory trajectory = ahead(10);
  OfflineOptions options;
  options.rate_hz = 50.0;
  const SweepFrames frames = sweeps_of(head, trajectory, options);
  const int bins = frames.settings_json()["bins"];
  npy::Table samples{bins, 200, std::vector<std::uint8_t>(static_cast<std::size_t>(bins) * 200U), {}};
  samples.u8[7 * 200 + 50] = 99;
  const std::vector<PingSent> pings = frames.pings(1, npy::encode(samples));
  ASSERT_EQ(pings.size(), 200U);
  const PingSent& line = pings[50];  // line 250 in all
  EXPECT_EQ(line.ping.number, 250U);
  EXPECT_EQ(line.ping.samples[7], 99);
  EXPECT_NEAR(line.ping.bearings_rad.front(), std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(line.ping.transmit_time.count(), frames.unix_ns(0) + 5 * ns_per_s);
  EXPECT_DOUBLE_EQ(line.poses->T_world_vehicle.position_m.x, 5.0);
  EXPECT_TRUE(
      frames.pings(1, npy::encode({bins, 1, std::vector<std::uint8_t>(static_cast<std::size_t>(bins)), {}}))
          .empty());
}

TEST(SweepFrames, ATurnEndsBeforeItsFirstBearingComesAgain) {
  const HeadConfig head = micron_type().make_default();
  const VehicleTrajectory trajectory = ahead(10);
  OfflineOptions options;
  options.rate_hz = 50.0;  // 501 lines
  const SweepFrames frames = sweeps_of(head, trajectory, options);
  EXPECT_EQ(frames.count(), 2);
  EXPECT_EQ(frames.first_line(1), 200);
  EXPECT_EQ(frames.first_line(2), 400);
  // Ahead first, then clockwise: line 50 points to starboard, which is -y.
  const glm::dvec3 ahead_axis = frames.request(0).T_world_sonar.orientation * glm::dvec3(1, 0, 0);
  const glm::dvec3 axis = frames.request(50).T_world_sonar.orientation * glm::dvec3(1, 0, 0);
  EXPECT_NEAR(ahead_axis.x, 1.0, 1e-12);
  EXPECT_NEAR(axis.y, -1.0, 1e-12);
  EXPECT_EQ(frames.request(250).ping_number, 250U);
  EXPECT_DOUBLE_EQ(frames.request(250).T_world_sonar.position_m.x, 5.0);
}

TEST(SweepFrames, ASweepEndsWithTheLineAtTheOtherLimit) {
  const HeadConfig head = micron_type().make_default();
  const VehicleTrajectory trajectory = ahead(3);
  OfflineOptions options;
  options.rate_hz = 50.0;                     // 151 lines
  options.survey.sector_deg = {-45.0, 45.0};  // 51 bearings
  const SweepFrames frames = sweeps_of(head, trajectory, options);
  ASSERT_EQ(frames.count(), 3);
  EXPECT_EQ(frames.first_line(1), 51);
  EXPECT_EQ(frames.first_line(2), 101);
  EXPECT_EQ(frames.first_line(3), 151);
  const auto azimuth_rad = [&](int line) {
    const glm::dvec3 axis = frames.request(line).T_world_sonar.orientation * glm::dvec3(1, 0, 0);
    return std::atan2(axis.y, axis.x);
  };
  EXPECT_NEAR(azimuth_rad(0), std::numbers::pi / 4, 1e-12);  // port first
  EXPECT_NEAR(azimuth_rad(50), -std::numbers::pi / 4, 1e-12);
  EXPECT_NEAR(azimuth_rad(100), std::numbers::pi / 4, 1e-12);
}

TEST(SweepFrames, WithoutTimeForASweepThereIsNone) {
  const HeadConfig head = micron_type().make_default();
  const VehicleTrajectory trajectory = ahead(1);
  EXPECT_EQ(sweeps_of(head, trajectory, {}).count(), 0);
}

TEST(SweepFrames, GoIntoNoLogOfFans) {
  const HeadConfig head = micron_type().make_default();
  const VehicleTrajectory trajectory = ahead(10);
  const SweepFrames frames = sweeps_of(head, trajectory, {});
  EXPECT_FALSE(frames.makes_glf());
  EXPECT_FALSE(frames.record(0, {}));
}

// ---- Data beside the samples

/// A board 0.8 m ahead of the origin, from y = 1 m (port) to y = `right_m`.
render::World board(float right_m = -1.0F) {
  auto mesh = std::make_shared<render::TriangleMesh>();
  mesh->positions = {{0.8F, 1, -1}, {0.8F, 1, 1}, {0.8F, right_m, 1}, {0.8F, right_m, -1}};
  mesh->indices = {0, 1, 2, 0, 2, 3};
  render::World world;
  render::Body& body = world.bodies.emplace_back();
  body.name = "board";
  body.parts.push_back({mesh, {}, {}, nullptr});
  return world;
}

TEST(FanFrames, SayWhatTheyAreAndWithWhatTheyAreMade) {
  HeadConfig head = gemini([](gemini::DeviceConfig& device) { device.sonar_id = 777; });
  head.name = "bow";
  head.seed = 5;
  const VehicleTrajectory trajectory = ahead(1);
  OfflineOptions options;
  options.rate_hz = 2.0;
  options.radius_px = 64;
  options.survey.range_m = 1.0;
  options.survey.compression_log2 = 2;
  FanFrames frames = fans_of(head, {3, 0}, trajectory, options);
  render::SonarRenderer renderer(board(), {render::EngineKind::cpu, 0});
  const Frame frame = frames.render(renderer, 1);
  for (const char* line :
       {"\n  \"frame\": 1,\n", "\n  \"head\": \"bow\",\n", "\n  \"type\": \"gemini_720i\",\n",
        "\n  \"stamp_s\": 100.5,\n", "\n  \"device_id\": 777,\n", "\n  \"ping_number\": 1,\n",
        "\n  \"head_index\": 3,\n", "\n  \"seed\": 5,\n", R"("axes":["line","beam"],"shape":[30,256]})",
        "\n  \"truth\": null\n",
        R"("settings": {"range_m":1.0,"gain_percent":50.0,"sound_speed_mps":1500.0,)"
        R"("compression":2,"bits":8,"native_lines":121,"period_s":0.5},)"}) {
    EXPECT_THAT(frame.sidecar, HasSubstr(line));
  }
  EXPECT_EQ(frame.sidecar.find("sonar_id"), std::string::npos);
  const auto samples = npy::parse(frame.npy);
  ASSERT_TRUE(samples);
  const auto record = frames.record(1, frame.npy);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->pixels, samples->u8);
}

TEST(FanFrames, OfSixteenBitsTheLogHasTheHighOnes) {
  const HeadConfig head = gemini_type().make_default();
  const VehicleTrajectory trajectory = ahead(1);
  OfflineOptions options;
  options.radius_px = 64;
  options.survey.range_m = 1.0;
  options.survey.bits = 16;
  const FanFrames frames = fans_of(head, {}, trajectory, options);
  std::vector<std::uint16_t> samples(121U * 256U, 0x1234);
  samples[0] = 0xFF01;
  const auto record = frames.record(0, npy::encode({121, 256, {}, samples}));
  ASSERT_TRUE(record);
  std::vector<std::uint8_t> expected(samples.size(), 0x12);
  expected[0] = 0xFF;
  EXPECT_EQ(record->pixels, expected);
  EXPECT_FALSE(frames.record(0, npy::encode({121, 256, expected, {}}))) << "they are not of this frame";
}

TEST(SweepFrames, SayWhatTheyAreAndWithWhatTheyAreMade) {
  HeadConfig head = micron_type().make_default();
  auto config = std::make_shared<MicronConfig>();
  config->device.node = 9;
  head.device = config;
  head.name = "mast";
  const VehicleTrajectory trajectory = ahead(1);
  OfflineOptions options;
  options.rate_hz = 50.0;
  options.radius_px = 64;
  options.survey.range_m = 2.0;
  options.survey.bins = 40;
  options.survey.step_deg = 9.0;
  options.survey.sector_deg = {-45.0, 45.0};
  SweepFrames frames = sweeps_of(head, trajectory, options);
  render::SonarRenderer renderer(board(), {render::EngineKind::cpu, 0});
  frames.pass(renderer, 0);
  const Frame frame = frames.render(renderer, 1);
  for (const char* line :
       {"\n  \"frame\": 1,\n", "\n  \"head\": \"mast\",\n", "\n  \"type\": \"micron\",\n",
        "\n  \"device_id\": 9,\n", "\n  \"first_ping_number\": 11,\n",
        R"("axes":["bin","line"],"shape":[40,10]})",
        R"("settings": {"range_m":2.0,"gain_percent":50.0,"sound_speed_mps":1500.0,"bins":40,)"
        R"("step_deg":9.0,"sector_deg":[-45)",
        "\"period_s\":0.02},\n  \"stamps_s\": [100.22,"}) {
    EXPECT_THAT(frame.sidecar, HasSubstr(line));
  }
  const auto samples = npy::parse(frame.npy);
  ASSERT_TRUE(samples);
  EXPECT_EQ(samples->rows, 40);
  EXPECT_EQ(samples->columns, 10);
}

// ---- Pictures

/// Difference of the echo levels of the left and right halves of a picture over their sum: 1 if all echoes
/// are on the left. Echoes have the colours of fire; grid and letters are grey.
double left_over_right(const cv::Mat& picture) {
  const auto loudness = [&](int first, int end) {
    double sum = 0.0;
    for (int row = 0; row < picture.rows; ++row) {
      for (int column = first; column < end; ++column) {
        const auto& colour = picture.at<cv::Vec3b>(row, column);
        sum += std::max(0, colour[2] - colour[0]);  // red above blue
      }
    }
    return sum;
  };
  const double left = loudness(0, picture.cols / 2);
  const double right = loudness(picture.cols / 2, picture.cols);
  return (left - right) / (left + right);
}

OfflineOptions quiet_options() {
  OfflineOptions options;
  options.rate_hz = 50.0;
  options.radius_px = 200;
  options.survey.range_m = 1.5;
  return options;
}

void take_noise_off(HeadConfig& head) {
  head.acoustics.physical.noise.on = false;
  head.acoustics.physical.speckle.kind = render::SpeckleSettings::Kind::off;
  head.acoustics.physical.ring_down.on = false;
  head.acoustics.physical.noise.interference.probability = 0.0;
}

TEST(FanFrames, HavePortOnTheLeftOfTheirPictures) {
  HeadConfig head = gemini_type().make_default();
  take_noise_off(head);
  const VehicleTrajectory trajectory = ahead(1, 0.0);
  FanFrames frames = fans_of(head, {}, trajectory, quiet_options());
  render::SonarRenderer renderer(board(0.3F), {render::EngineKind::cpu, 0});
  EXPECT_GT(left_over_right(frames.render(renderer, 0).draw()), 0.3);
}

TEST(SweepFrames, HavePortOnTheLeftOfTheirPicturesHoweverTheHeadIsMounted) {
  for (const bool inverted : {false, true}) {
    SCOPED_TRACE(inverted ? "boot down" : "boot up");
    HeadConfig head = micron_type().make_default();
    take_noise_off(head);
    auto config = std::make_shared<MicronConfig>();
    config->device.mounted_inverted = inverted;
    head.device = config;
    const VehicleTrajectory trajectory = ahead(5, 0.0);
    OfflineOptions options = quiet_options();
    render::SonarRenderer renderer(board(0.3F), {render::EngineKind::cpu, 0});
    SweepFrames turns = sweeps_of(head, trajectory, options);
    EXPECT_GT(left_over_right(turns.render(renderer, 0).draw()), 0.3);
    // An asymmetric sector, which misses the board if it is on the wrong side. In the head's angles it
    // reaches from 80 degrees on the board's side to 10 degrees beyond ahead.
    options.survey.sector_deg = inverted ? std::vector{-10.0, 80.0} : std::vector{-80.0, 10.0};
    SweepFrames sweeps = sweeps_of(head, trajectory, options);
    EXPECT_GT(left_over_right(sweeps.render(renderer, 0).draw()), 0.3);
  }
}

}  // namespace
}  // namespace sonard::server
