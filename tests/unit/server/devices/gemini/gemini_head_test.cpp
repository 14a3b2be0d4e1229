// SPDX-License-Identifier: Apache-2.0
#include "server/devices/head.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/head_status.hpp"
#include "server/devices/ping_viewer.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/pose/pose_history.hpp"
#include "server/rendering/render_service.hpp"
#include "tests/support/fake_renderer.hpp"
#include "tests/support/head_counts.hpp"
#include "tests/support/loopback.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;
using Bytes = std::vector<std::uint8_t>;

// Commands of protocol/gemini/README.md 10, for sonar ID 601.
const Bytes status_request{0x20, 0x01, 0x59, 0x02, 0, 0, 0, 0};
// Single ping, 8 bit, pings out of water too, 483 lines, speed of sound from the configuration.
const Bytes ping_config{0x21, 0x01, 0x59, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                        0x00, 0x00, 0x00, 0x00, 0x04, 0x02, 0x00, 0x00, 0xe3, 0x01, 0x40, 0x0d, 0x03, 0x00,
                        0x04, 0x00, 0x00, 0x00, 0xe8, 0x83, 0x00, 0x00, 0x00, 0x1e, 0x00, 0x00, 0x43, 0x00,
                        0x00, 0x00, 0x07, 0x00, 0x01, 0x00, 0x90, 0x3a, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00,
                        0x00, 0x00, 0x00, 0x00, 0x01, 0x1d, 0x00, 0x00, 0x01, 0x12, 0x1e, 0x11};
constexpr int config_lines = 483;

Bytes not_out_of_water(Bytes config) {
  config[19] = 0x00;  // extMode bit 9
  return config;
}

Bytes externally_triggered(Bytes config) {
  config[16] = 0x02;
  return config;
}

// One head and a client on one io_context that the test runs.
struct GeminiHeadTest : testing::Test {
  const Ipv4 head_address = test::own_loopback_address(2);
  const Ipv4 client_address = test::own_loopback_address(1);
  const Ipv4 unauthorised_address = test::own_loopback_address(99);

  asio::io_context io;
  SteadyClock clock;
  std::shared_ptr<test::FakeRendererControl> renderer = std::make_shared<test::FakeRendererControl>();
  PoseConfig pose_config;
  HeadConfig config = gemini_type().make_default();
  GeminiConfig gemini_config;
  std::optional<double> water_surface_z_m;
  std::string vehicle_model;
  PingViewer* viewer = nullptr;

  std::unique_ptr<PoseHistory> poses;
  std::unique_ptr<RenderService> service;
  std::unique_ptr<Head> head;
  UdpEndpoint client{io, {client_address, 52900}};
  std::vector<Datagram> received;

  GeminiHeadTest() {
    pose_config.T_world_vehicle_initial = render::Pose{};
    config.name = "head";
    gemini_config.device.sonar_id = 601;
    gemini_config.device.alternate_address = head_address;
    gemini_config.device.netmask = 0xFF000000;
    gemini_config.bind_address = head_address;
    gemini_config.status = {StatusDestination::Mode::unicast, {client_address}};
    gemini_config.allow = {{client_address, 32}};
    client.start([this](const Datagram& datagram) { received.push_back(datagram); });
  }

  ~GeminiHeadTest() override {
    if (head) {
      head->stop();
    }
    if (service) {
      service->stop();
    }
  }

  void start() {
    poses = std::make_unique<PoseHistory>(pose_config);
    RenderServiceHooks hooks;
    hooks.post = [this](std::function<void()> task) { asio::post(io, std::move(task)); };
    hooks.on_failure = [](const std::string& what) { FAIL() << what; };
    service = std::make_unique<RenderService>(test::fake_renderer_factory(renderer), 1, hooks);
    HeadServices services{io, clock, *service, *poses, water_surface_z_m};
    services.vehicle_model = vehicle_model;
    services.viewer = viewer;
    config.device = std::make_shared<GeminiConfig>(gemini_config);
    head = std::make_unique<Head>(config, 0, services);
    head->start();
  }

  void command(const Bytes& bytes) { client.send({{{head_address, 52901}, 0, SharedBytes(bytes)}}); }

  std::vector<Bytes> of_type(std::uint8_t type) const {
    std::vector<Bytes> found;
    for (const Datagram& datagram : received) {
      if (datagram.bytes.size() > 0 && datagram.bytes[0] == type) {
        found.emplace_back(datagram.bytes.begin(), datagram.bytes.end());
      }
    }
    return found;
  }

  bool run_until(const std::function<bool()>& done,
                 std::chrono::milliseconds limit = std::chrono::seconds{10}) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!done() && std::chrono::steady_clock::now() < deadline) {
      io.run_one_for(std::chrono::milliseconds{10});
      io.restart();
    }
    return done();
  }

  bool run_until_received(std::uint8_t type, std::size_t count) {
    return run_until([&] { return of_type(type).size() >= count; });
  }
};

// When the first ping is sent, memory runs out for its viewers.
TEST_F(GeminiHeadTest, MemoryThatRunsOutCostsAPingAtMost) {
  struct : PingViewer {
    int shown = 0;
    void show(std::shared_ptr<const ShownPing>) override {
      if (shown++ == 0) {
        throw std::bad_alloc();
      }
    }
  } without_memory;
  viewer = &without_memory;
  start();
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return without_memory.shown == 1; }));
  ASSERT_TRUE(run_until_received(0x42, config_lines)) << "what goes onto the wire is not lost with it";
  command(ping_config);
  EXPECT_TRUE(run_until([&] { return without_memory.shown == 2; }));
}

TEST_F(GeminiHeadTest, SendsStatusFromItsCommandPort) {
  start();
  ASSERT_TRUE(run_until_received(0x40, 1));
  EXPECT_EQ(received[0].bytes.size(), 110u);
  EXPECT_EQ(received[0].remote, (Endpoint{head_address, 52901}));
}

TEST_F(GeminiHeadTest, AnswersToPort52900WhateverTheSourcePort) {
  start();
  UdpEndpoint elsewhere(io, {client_address, 0});
  elsewhere.send({{{head_address, 52901}, 0, SharedBytes(status_request)}});
  ASSERT_TRUE(run_until_received(0x49, 1));
}

TEST_F(GeminiHeadTest, BoundToAllAddressesItAnswersFromTheOneAddressed) {
  gemini_config.bind_address = 0;
  gemini_config.command_port =
      static_cast<std::uint16_t>(20000 + getpid() % 20000);  // on all addresses, because 52901 may be in use
  start();
  const Ipv4 other = test::own_loopback_address(77);
  client.send({{{other, gemini_config.command_port}, 0, SharedBytes(status_request)}});
  ASSERT_TRUE(run_until_received(0x49, 1));
  for (const Datagram& datagram : received) {
    EXPECT_EQ(datagram.remote.address, datagram.bytes[0] == 0x49 ? other : head_address);
  }
}

TEST_F(GeminiHeadTest, SendsWhatTheRendererHandedOver) {
  start();
  command(ping_config);
  ASSERT_TRUE(run_until_received(0x43, 1));
  ASSERT_EQ(of_type(0x41).size(), 1u);
  const std::vector<Bytes> lines = of_type(0x42);
  ASSERT_EQ(lines.size(), static_cast<std::size_t>(config_lines));
  const std::uint64_t ping_number = renderer->recorded().at(0).ping_number;
  for (int line = 0; line < config_lines; ++line) {
    const Bytes& bytes = lines[static_cast<std::size_t>(line)];
    ASSERT_EQ(bytes.size(), 272u);
    ASSERT_EQ(bytes[10] | bytes[11] << 8, line);
    for (int beam = 0; beam < 256; ++beam) {
      ASSERT_EQ(bytes[16 + static_cast<std::size_t>(beam)], test::fake_sample(ping_number, line, beam));
    }
  }
}

TEST_F(GeminiHeadTest, RendersFromVehiclePoseTimesMount) {
  // The vehicle is at (10, 0, -5), turned 90 degrees to port. The sonar is 1 m ahead of it.
  pose_config.T_world_vehicle_initial =
      render::Pose{{10, 0, -5}, glm::dquat(std::sqrt(0.5), 0, 0, std::sqrt(0.5))};
  config.T_vehicle_sonar.position_m = {1, 0, 0};
  config.seed = 77;
  start();
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return renderer->pings > 0; }));
  const render::PingRequest request = renderer->recorded().at(0);
  EXPECT_NEAR(request.T_world_sonar.position_m.x, 10, 1e-12);
  EXPECT_NEAR(request.T_world_sonar.position_m.y, 1, 1e-12);
  EXPECT_NEAR(request.T_world_sonar.position_m.z, -5, 1e-12);
  EXPECT_EQ(request.seed, 77u);
  EXPECT_EQ(request.settings.range.count, config_lines);
}

// The ping listens for 483 lines of 2 / 180844 s. The twist of the newest pose gives the pose after that
// time.
TEST_F(GeminiHeadTest, SaysWhereTheSonarIsWhenTheLastEchoIsHeard) {
  start();
  pose::PoseSample sample;
  sample.time_ns = 1;
  sample.twist = pose::Velocity{{2, 0, 0}, {0, 0, 0.5}};
  poses->insert(sample, clock.now());
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return renderer->pings > 0; }));
  const render::PingRequest request = renderer->recorded().at(0);
  ASSERT_TRUE(request.T_world_sonar_at_end);
  const double listening_s = config_lines / 90'422.0;
  const render::Pose moved = render::inverse(request.T_world_sonar) * *request.T_world_sonar_at_end;
  EXPECT_NEAR(glm::angle(moved.orientation), 0.5 * listening_s, 1e-7);
  EXPECT_GT(moved.orientation.z, 0) << "to port";
  EXPECT_NEAR(moved.position_m.x, 2 * listening_s, 1e-6);
}

TEST_F(GeminiHeadTest, AtRestItEndsAPingWhereItBegan) {
  start();
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return renderer->pings > 0; }));
  const render::PingRequest request = renderer->recorded().at(0);
  EXPECT_EQ(request.T_world_sonar_at_end, request.T_world_sonar);
}

TEST_F(GeminiHeadTest, ForwardsPosesOfBodies) {
  std::vector<std::string> moved;
  start();
  pose::PoseSample sample;
  sample.time_ns = 1;
  sample.bodies.push_back({"door", {}});
  poses->insert(sample, clock.now());
  EXPECT_EQ(poses->bodies_at(clock.now()).size(), 1u);
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return renderer->pings > 0; }));
  EXPECT_EQ(renderer->moved_bodies(), std::vector<std::string>{"door"});
}

// The pose stream has a pose for the model of the vehicle too, which is ignored.
TEST_F(GeminiHeadTest, MovesTheModelOfTheVehicleWithTheVehicle) {
  vehicle_model = "rov";
  start();
  pose::PoseSample sample;
  sample.time_ns = 1;
  sample.T_world_vehicle.position_m = {3, 4, 5};
  sample.bodies = {{"door", {}}, {"rov", {{-1, -1, -1}, {1, 0, 0, 0}}}};
  poses->insert(sample, clock.now());
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return renderer->pings > 0; }));
  EXPECT_EQ(renderer->moved_bodies(), (std::vector<std::string>{"door", "rov"}));
  EXPECT_EQ(renderer->pose_of_body("rov").position_m, glm::dvec3(3, 4, 5));
}

TEST_F(GeminiHeadTest, PutsAHiddenVehicleOutOfReach) {
  vehicle_model = "rov";
  config.hides_vehicle = true;
  start();
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return renderer->pings > 0; }));
  EXPECT_GT(glm::length(renderer->pose_of_body("rov").position_m), 1e5);
}

TEST_F(GeminiHeadTest, DropsAndCountsUnauthorisedPeers) {
  start();
  UdpEndpoint unauthorised(io, {unauthorised_address, 52900});
  std::size_t answers = 0;
  unauthorised.start([&](const Datagram&) { ++answers; });
  unauthorised.send({{{head_address, 52901}, 0, SharedBytes(status_request)}});
  ASSERT_TRUE(run_until([&] { return test::transport_count(*head, "not_allowed") == 1; }));
  // A later answer to a permitted client has arrived, but no answer to the unauthorised peer.
  command(status_request);
  ASSERT_TRUE(run_until_received(0x49, 1));
  EXPECT_EQ(answers, 0u);
}

TEST_F(GeminiHeadTest, WithoutAPoseItAnswersButDoesNotPing) {
  pose_config.T_world_vehicle_initial.reset();
  start();
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return head->render_counters().pings_without_pose == 1; }));
  command(status_request);
  ASSERT_TRUE(run_until_received(0x49, 1));
  EXPECT_TRUE(of_type(0x41).empty());
  EXPECT_EQ(renderer->pings, 0);
}

std::vector<std::string> codes_of(const std::vector<Finding>& findings) {
  std::vector<std::string> codes;
  for (const Finding& finding : findings) {
    codes.push_back(finding.code);
  }
  return codes;
}

// In simulated time a pose of the configuration brings no stamp, so pings wait.
TEST_F(GeminiHeadTest, WithoutAStampItSaysThatItWaitsForAPose) {
  for (const PingClock by : {PingClock::simulated, PingClock::simulated_lock_step}) {
    pose_config.clock = by;
    gemini_config.device.simulated_time = true;
    start();
    EXPECT_TRUE(head->status().findings.empty()) << "no client requests pings";
    command(ping_config);
    ASSERT_TRUE(run_until([&] { return !head->status().findings.empty(); }));
    EXPECT_EQ(codes_of(head->status().findings), std::vector<std::string>{"no_pose"});
    pose::PoseSample sample;
    sample.time_ns = 1;
    poses->insert(sample, clock.now());
    EXPECT_TRUE(head->status().findings.empty());
    head->stop();
    service->stop();
    head.reset();
  }
}

TEST_F(GeminiHeadTest, AStalePoseIsNotAMissingOne) {
  pose_config.stale_policy = StalePolicy::silence;
  start();
  pose::PoseSample sample;
  sample.time_ns = 1;
  poses->insert(sample, clock.now() - std::chrono::seconds{7});
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return !head->status().findings.empty(); }));
  const std::vector<Finding> findings = head->status().findings;
  EXPECT_EQ(codes_of(findings), std::vector<std::string>{"stale_pose"});
  EXPECT_NE(findings[0].text.find("the newest one is 7.0 s old"), std::string::npos) << findings[0].text;
}

TEST_F(GeminiHeadTest, NamesBothIdsOfCommandsForAnotherHead) {
  start();
  Bytes other = status_request;
  other[2] = 0x5a;  // 602
  command(other);
  ASSERT_TRUE(run_until([&] { return !head->status().findings.empty(); }));
  EXPECT_EQ(codes_of(head->status().findings), std::vector<std::string>{"misaddressed"});
  EXPECT_EQ(
      head->status().findings[0].text,
      "A client sends commands for sonar ID 602, but this head has sonar ID 601. Set sonar_id to the ID "
      "of the client's sonar.");
}

// If rendering is further ahead than a ping period, the next ping is due at once after one that failed.
TEST_F(GeminiHeadTest, RenderingAheadItKeepsTryingWithoutAPose) {
  pose_config.T_world_vehicle_initial.reset();
  gemini_config.device.render_lead = std::chrono::milliseconds{35};
  start();
  Bytes continuous = ping_config;
  continuous[16] = 0x01;
  continuous[24] = 0xe8;  // 33000 us, below the head's own limit of 33.3 ms
  continuous[25] = 0x80;
  continuous[26] = 0x00;
  command(continuous);
  // 20 periods are 0.67 s, less than a status period. The status timer can therefore not cause these pings.
  EXPECT_TRUE(run_until([&] { return head->render_counters().pings_without_pose >= 20; },
                        std::chrono::milliseconds{950}));
}

TEST_F(GeminiHeadTest, PingsAgainWhenAPoseHasArrived) {
  pose_config.T_world_vehicle_initial.reset();
  start();
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return head->render_counters().pings_without_pose == 1; }));
  pose::PoseSample sample;
  sample.time_ns = 1;
  poses->insert(sample, clock.now());
  command(ping_config);
  ASSERT_TRUE(run_until_received(0x43, 1));
}

TEST_F(GeminiHeadTest, OutOfTheWaterItDoesNotPingUnlessToldTo) {
  water_surface_z_m = -1.0;  // the sonar is at z = 0
  start();
  command(not_out_of_water(ping_config));
  ASSERT_TRUE(run_until([&] { return test::device_count(*head, "pings_suppressed") > 0; }));
  EXPECT_TRUE(of_type(0x41).empty());
  command(ping_config);
  ASSERT_TRUE(run_until_received(0x43, 1));
}

TEST_F(GeminiHeadTest, NoticesThatItLeavesTheWater) {
  water_surface_z_m = 1.0;  // the sonar is at z = 0
  start();
  command(not_out_of_water(ping_config));
  ASSERT_TRUE(run_until_received(0x43, 1));
  pose::PoseSample sample;
  sample.time_ns = 1;
  sample.T_world_vehicle.position_m = {0, 0, 2};
  poses->insert(sample, clock.now());
  EXPECT_TRUE(run_until([&] {
    command(not_out_of_water(ping_config));
    return test::device_count(*head, "pings_suppressed") > 0;
  }));
}

TEST_F(GeminiHeadTest, FaultsOfTheLinkApplyInBothDirections) {
  gemini_config.link.to_client.duplicate = 1.0;
  gemini_config.link.from_client.delay = std::chrono::milliseconds{80};
  start();
  const auto sent = std::chrono::steady_clock::now();
  command(status_request);
  ASSERT_TRUE(run_until_received(0x49, 2));
  EXPECT_GE(std::chrono::steady_clock::now() - sent, std::chrono::milliseconds{80});
  EXPECT_EQ(of_type(0x49)[0], of_type(0x49)[1]);
}

TEST_F(GeminiHeadTest, DatagramAtTheTriggerSocketIsOneEdge) {
  gemini_config.trigger = Endpoint{head_address, 14700};
  start();
  command(externally_triggered(ping_config));
  command(status_request);
  ASSERT_TRUE(run_until_received(0x49, 1));
  EXPECT_EQ(renderer->pings, 0);
  client.send({{*gemini_config.trigger, 0, SharedBytes(Bytes{1})}});
  ASSERT_TRUE(run_until_received(0x43, 1));
  EXPECT_EQ(renderer->pings, 1);
}

// protocol/gemini/README.md 3.7 and 3.9: bank 2 holds address and mask, and a reboot applies them.
TEST_F(GeminiHeadTest, MovesToTheAddressThatAClientHasProgrammed) {
  gemini_config.device.reboot_time = std::chrono::milliseconds{50};
  start();
  const Ipv4 new_address = test::own_loopback_address(44);
  Bytes write_bank_2(152);
  const Bytes start_of_write{0x24, 0x01, 0x59, 0x02, 0, 0, 0, 0, 0x02};
  std::copy(start_of_write.begin(), start_of_write.end(), write_bank_2.begin());
  for (int i = 0; i < 4; ++i) {
    write_bank_2[static_cast<std::size_t>(16 + i)] = static_cast<std::uint8_t>(new_address >> (8 * i));
  }
  write_bank_2[23] = 0xFF;  // mask 255.0.0.0
  command(write_bank_2);
  ASSERT_TRUE(run_until_received(0x44, 1));
  command({0x2b, 0x01, 0x59, 0x02, 0, 0, 0, 0, 0x01, 0, 0, 0});
  const auto is_from_new_address = [&] {
    return !received.empty() && received.back().bytes[0] == 0x40 &&
           received.back().remote.address == new_address;
  };
  ASSERT_TRUE(run_until(is_from_new_address));
  client.send({{{new_address, 52901}, 0, SharedBytes(status_request)}});
  ASSERT_TRUE(run_until_received(0x49, 1));
  EXPECT_EQ(received.back().remote.address, new_address);
}

TEST_F(GeminiHeadTest, AnswerToAHeadThatIsGoneIsHarmless) {
  start();
  command(ping_config);
  ASSERT_TRUE(run_until([&] { return renderer->pings > 0; }));
  head.reset();
  io.run_for(std::chrono::milliseconds{20});
}

}  // namespace
}  // namespace sonard::server
