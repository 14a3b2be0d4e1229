// SPDX-License-Identifier: Apache-2.0
// The heads that serve recorded heads, and the recordings that a head cannot play.
#include "server/replay/replay_config.hpp"

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "protocol/gemini/bearings.hpp"
#include "protocol/micron/recorded_form.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/micron/config.hpp"
#include "server/devices/micron/type.hpp"
#include "server/pose/udp/input.hpp"

namespace sonard::server {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

RecordedSettings settings(double bin_m = 1500.0 / (2 * 90422.0)) {
  RecordedSettings settings;
  settings.bins = 482;
  settings.beams = 256;
  settings.bin_m = bin_m;
  settings.sound_speed_mps = 1500.0;
  settings.gain_percent = 50.0;
  return settings;
}

/// A head of a Gemini, in a log that does not name the device.
LoggedHead fan(std::uint16_t device_id, const std::string& name = "") {
  LoggedHead head;
  head.name = name;
  head.device_id = device_id;
  head.pings.push_back({.settings = settings(), .wire = {}});
  head.bearings_rad = gemini::bearings_rad();
  return head;
}

HeadConfig gemini(const std::string& name, std::uint16_t id) {
  HeadConfig head = gemini_type().make_default();
  head.name = name;
  auto config = std::make_shared<GeminiConfig>(device_settings<GeminiConfig>(head));
  config->device.sonar_id = id;
  config->device.simulated_time = true;
  config->device.render_lead = std::chrono::milliseconds{5};
  head.device = config;
  return head;
}

struct ReplayConfigTest : testing::Test {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("sonard-replay-" + std::to_string(getpid()) + ".dat");
  DaemonConfig config;

  ReplayConfigTest() {
    std::ofstream(path) << "\xDE\xDE";
    spdlog::set_level(spdlog::level::off);
  }
  ~ReplayConfigTest() override {
    std::filesystem::remove(path);
    spdlog::set_level(spdlog::level::info);
  }

  ReplayConfig replay(const std::vector<LoggedHead>& logged) const {
    return replay_config(config, logged, LogFile(path));
  }
  DaemonConfig loopback(const std::vector<LoggedHead>& logged) const {
    return loopback_config(logged, LogFile(path));
  }
  /// The error message for playing these heads on loopback, without the name of the log.
  std::string complaint(const std::vector<LoggedHead>& logged) const {
    return complaint([&] { replay_config(loopback(logged), logged, LogFile(path)); });
  }
  /// The error message for playing these heads on the heads of `config`.
  std::string configured_complaint(const std::vector<LoggedHead>& logged) const {
    return complaint([&] { replay(logged); });
  }

 private:
  std::string complaint(const std::function<void()>& play) const {
    try {
      play();
    } catch (const Error& error) {
      const std::string before = path.string() + ": ";
      EXPECT_THAT(error.what(), StartsWith(before));
      return std::string(error.what()).substr(before.size());
    }
    return "it is played";
  }
};

TEST_F(ReplayConfigTest, HeadsFindTheirRecordingById) {
  config.heads = {gemini("a", 600), gemini("b", 513), micron_type().make_default()};
  const std::vector<LoggedHead> logged{fan(513), fan(600)};
  const ReplayConfig replay = this->replay(logged);
  ASSERT_EQ(replay.played.size(), 2U);
  EXPECT_EQ(replay.daemon.heads.size(), 2U);
  EXPECT_EQ(replay.played[0].logged, &logged[1]);
  EXPECT_EQ(replay.played[1].logged, &logged[0]);
  EXPECT_EQ(replay.played[0].name, "a");
  EXPECT_EQ(replay.daemon.heads[0].name, "a");
}

TEST_F(ReplayConfigTest, ANameSaysMoreThanAnId) {
  config.heads = {gemini("a", 600), gemini("b", 513)};
  const std::vector<LoggedHead> logged{fan(600, "b"), fan(513, "a")};
  const ReplayConfig replay = this->replay(logged);
  ASSERT_EQ(replay.played.size(), 2U);
  EXPECT_EQ(replay.played[0].logged, &logged[1]);
  EXPECT_EQ(replay.played[1].logged, &logged[0]);
}

TEST_F(ReplayConfigTest, HeadsAreHeldToTheirRecordingAndKeepTheRest) {
  config.heads = {gemini("a", 600), gemini("b", 601)};
  config.poses.inputs = {pose_input(UdpPoseInput{})};
  const ReplayConfig replay = this->replay({fan(600), fan(601)});
  ASSERT_EQ(replay.daemon.heads.size(), 2U);
  for (const HeadConfig& head : replay.daemon.heads) {
    const gemini::DeviceConfig& device = device_settings<GeminiConfig>(head).device;
    EXPECT_TRUE(device.plays_back);
    EXPECT_FALSE(device.simulated_time);
    EXPECT_EQ(device.min_ping_period, std::chrono::milliseconds{1});
    EXPECT_EQ(device.render_lead, std::chrono::nanoseconds{0});
  }
  EXPECT_EQ(device_settings<GeminiConfig>(replay.daemon.heads[1]).device.sonar_id, 601);
  EXPECT_FALSE(device_settings<GeminiConfig>(config.heads[0]).device.plays_back)
      << "that of others is not changed";
  EXPECT_TRUE(replay.daemon.poses.inputs.empty()) << "nothing is rendered";
  EXPECT_TRUE(replay.daemon.poses.T_world_vehicle_initial);
}

TEST_F(ReplayConfigTest, OneHeadPlaysOneRecordingWhateverTheIds) {
  config.heads = {gemini("a", 600)};
  const std::vector<LoggedHead> logged{fan(513)};
  const ReplayConfig replay = this->replay(logged);
  EXPECT_EQ(replay.played.at(0).logged, &logged[0]);
  EXPECT_EQ(device_settings<GeminiConfig>(replay.daemon.heads.at(0)).device.sonar_id, 600);
}

TEST_F(ReplayConfigTest, NoHeadAtAllIsAnError) {
  config.heads = {gemini("a", 600), gemini("b", 601)};
  EXPECT_EQ(configured_complaint({fan(513)}), "has no pings for the heads to serve");
}

TEST_F(ReplayConfigTest, ImagesOfOtherHeadsAreAnErrorThatSaysSo) {
  std::vector<LoggedHead> logged{fan(513)};
  logged[0].pings[0].settings.beams = 512;
  const std::string why =
      "sonar 513 has an image of 482 range bins of 512 beams, which a Gemini 720i cannot send (expected 256 "
      "beams)";
  EXPECT_EQ(complaint(logged), "head 'gemini-513' cannot play it: " + why);
  config.heads = {gemini("a", 513)};
  EXPECT_EQ(configured_complaint(logged), "head 'a' cannot play it: " + why);
}

TEST_F(ReplayConfigTest, TimesThatMakeNoSenseAreAnError) {
  std::vector<LoggedHead> logged{fan(513)};
  logged[0].pings.push_back(
      {.time_ns = std::int64_t{91} * 86'400 * 1'000'000'000, .settings = settings(), .wire = {}});
  EXPECT_EQ(complaint(logged), "its times span 91 days (expected at most 90)");
  logged[0].pings.back().time_ns = std::int64_t{90} * 86'400 * 1'000'000'000;
  EXPECT_EQ(complaint(logged), "it is played");
}

// ---- Microns

LoggedHead scan(const std::string& name, std::uint16_t node) {
  LoggedPing line;
  line.settings.bins = 20;
  line.settings.beams = 1;
  line.wire = micron::recorded_wire({}, static_cast<std::uint8_t>(node));
  LoggedHead head;
  head.name = name;
  head.device_id = node;
  head.scanning = true;
  head.pings = {line};
  return head;
}

HeadConfig micron(const std::string& name, std::uint8_t node) {
  HeadConfig head = micron_type().make_default();
  head.name = name;
  auto config = std::make_shared<MicronConfig>(device_settings<MicronConfig>(head));
  config->device.node = node;
  config->device.simulated_time = true;
  head.device = config;
  return head;
}

TEST_F(ReplayConfigTest, MicronsFindTheirRecordingByNameAndElseByNode) {
  config.heads = {micron("a", 2), micron("b", 2), micron("c", 9), micron("d", 3)};
  const std::vector<LoggedHead> logged{scan("b", 2), scan("a", 2), scan("elsewhere", 9)};
  const ReplayConfig replay = this->replay(logged);
  ASSERT_EQ(replay.played.size(), 3U);
  EXPECT_EQ(replay.played[0].logged, &logged[1]);
  EXPECT_EQ(replay.played[1].logged, &logged[0]);
  EXPECT_EQ(replay.played[2].logged, &logged[2]);
  EXPECT_TRUE(device_settings<MicronConfig>(replay.daemon.heads[2]).device.plays_back);
  EXPECT_FALSE(device_settings<MicronConfig>(replay.daemon.heads[2]).device.simulated_time);
}

TEST_F(ReplayConfigTest, OneOfEachKindPlayOneOfEachKind) {
  config.heads = {gemini("a", 600), micron("mast", 7)};
  const std::vector<LoggedHead> logged{scan("stern", 2), fan(513)};
  const ReplayConfig replay = this->replay(logged);
  ASSERT_EQ(replay.played.size(), 2U);
  EXPECT_EQ(replay.played[0].logged, &logged[1]);
  EXPECT_EQ(replay.played[1].logged, &logged[0]);
}

TEST_F(ReplayConfigTest, HeadsOfTwoKindsWithOneIdEachPlayTheirOwn) {
  config.heads = {micron("a", 2), gemini("b", 2), micron("c", 3), gemini("d", 3)};
  const std::vector<LoggedHead> logged{fan(3), scan("", 3), fan(2), scan("", 2)};
  const ReplayConfig replay = this->replay(logged);
  ASSERT_EQ(replay.played.size(), 4U);
  EXPECT_EQ(replay.played[0].logged, &logged[3]);
  EXPECT_EQ(replay.played[1].logged, &logged[2]);
  EXPECT_EQ(replay.played[2].logged, &logged[1]);
  EXPECT_EQ(replay.played[3].logged, &logged[0]);
}

TEST_F(ReplayConfigTest, WithoutAConfigurationMicronsAreBehindTheGeminisOnLoopback) {
  const std::vector<LoggedHead> logged{scan("", 7), fan(513), scan("mast", 255), fan(1, "bow")};
  const DaemonConfig loopback = this->loopback(logged);
  ASSERT_EQ(loopback.heads.size(), 4U);

  ASSERT_EQ(loopback.heads[0].type, &gemini_type());
  EXPECT_EQ(loopback.heads[0].name, "gemini-513");
  const GeminiConfig& first = device_settings<GeminiConfig>(loopback.heads[0]);
  EXPECT_EQ(first.device.sonar_id, 513);
  EXPECT_EQ(first.device.mac, (std::array<std::uint8_t, 6>{0x00, 0x12, 0x34, 0x00, 0x02, 0x01}));
  EXPECT_EQ(first.device.alternate_address, 0x7F000002U);
  EXPECT_EQ(first.device.netmask, 0xFF000000U);
  EXPECT_EQ(first.bind_address, 0x7F000002U);
  EXPECT_EQ(first.status.mode, StatusDestination::Mode::unicast);
  EXPECT_THAT(first.status.hosts, ElementsAre(0x7F000001U));
  EXPECT_THAT(first.allow, ElementsAre(Cidr{0x7F000000, 8}));
  EXPECT_EQ(loopback.heads[1].name, "bow");
  EXPECT_EQ(device_settings<GeminiConfig>(loopback.heads[1]).bind_address, 0x7F000003U);
  EXPECT_EQ(device_settings<GeminiConfig>(loopback.heads[1]).device.sonar_id, 2)
      << "clients send nothing to 1";

  ASSERT_EQ(loopback.heads[2].type, &micron_type());
  EXPECT_EQ(loopback.heads[2].name, "micron-7");
  const MicronConfig& third = device_settings<MicronConfig>(loopback.heads[2]);
  EXPECT_EQ(third.device.node, 7);
  ASSERT_EQ(third.serial.tcp.size(), 1U);
  EXPECT_EQ(third.serial.tcp[0].bind.address, 0x7F000004U);
  EXPECT_EQ(third.serial.tcp[0].bind.port, 4001);
  EXPECT_THAT(third.serial.tcp[0].allow, ElementsAre(Cidr{0x7F000000, 8}));
  EXPECT_EQ(loopback.heads[3].name, "mast");
  EXPECT_EQ(device_settings<MicronConfig>(loopback.heads[3]).device.node, micron::DeviceConfig{}.node)
      << "255 is the host";
}

TEST_F(ReplayConfigTest, LinesThatDoNotSayHowTheyTravelledAreAnError) {
  config.heads = {micron("a", 2)};
  std::vector<LoggedHead> logged{scan("a", 2)};
  const std::string why = "scan lines of node 2 lack their wire format (expected wire_line)";
  logged[0].pings.push_back(logged[0].pings[0]);
  logged[0].pings[1].wire.clear();
  EXPECT_EQ(configured_complaint(logged), "head 'a' cannot play it: " + why);
  EXPECT_EQ(complaint(logged), why);
  logged[0].pings[1].wire = {1, 2, 3};
  EXPECT_EQ(configured_complaint(logged), "head 'a' cannot play it: " + why) << "that is no line";
}

TEST_F(ReplayConfigTest, LinesThatAreTooLongAreAnError) {
  config.heads = {micron("a", 2)};
  std::vector<LoggedHead> logged{scan("a", 2)};
  logged[0].pings[0].settings.bins = 1500;
  EXPECT_EQ(configured_complaint(logged), "it is played");
  logged[0].pings[0].settings.bins = 1501;
  const std::string why =
      "scan lines of node 2 have too many bins (expected at most 1500, as a Micron sends)";
  EXPECT_EQ(configured_complaint(logged), "head 'a' cannot play it: " + why);
  EXPECT_EQ(complaint(logged), why);
}

// ---- Logs that name the device

TEST_F(ReplayConfigTest, ALogSaysOfWhichKindItsHeadsAre) {
  std::vector<LoggedHead> logged{fan(513), scan("", 7)};
  logged[0].type = "gemini_720i";
  logged[1].type = "micron";
  const DaemonConfig loopback = this->loopback(logged);
  ASSERT_EQ(loopback.heads.size(), 2U);
  EXPECT_EQ(loopback.heads[0].type, &gemini_type());
  EXPECT_EQ(loopback.heads[1].type, &micron_type());
  EXPECT_EQ(complaint(logged), "it is played");
}

TEST_F(ReplayConfigTest, AKindThatALogNamesIsAskedWhetherItCanPlayIt) {
  std::vector<LoggedHead> logged{fan(513)};
  logged[0].type = "gemini_720i";
  logged[0].pings[0].settings.beams = 512;
  EXPECT_THAT(complaint(logged), AllOf(StartsWith("head 'gemini-513' cannot play it: sonar 513 has an image"),
                                       HasSubstr("(expected 256 beams)")));
}

TEST_F(ReplayConfigTest, HeadsOfADeviceThatNobodyKnowsAreAnError) {
  LoggedHead wide = fan(513, "bow");
  wide.pings[0].settings.beams = 512;  // a width that a Gemini would refuse
  for (LoggedHead head : {fan(513, "bow"), wide, scan("bow", 7)}) {
    head.type = "other_900";
    EXPECT_THAT(complaint({head}),
                StartsWith("head 'bow' has the unknown type 'other_900' (expected gemini_720i or micron"));
  }
}

}  // namespace
}  // namespace sonard::server
