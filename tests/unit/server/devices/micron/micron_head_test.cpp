// SPDX-License-Identifier: Apache-2.0
#include "server/devices/head.hpp"

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "protocol/micron/client.hpp"
#include "server/devices/micron/config.hpp"
#include "server/devices/micron/type.hpp"
#include "server/net/serial_transport.hpp"
#include "server/pose/pose_history.hpp"
#include "server/rendering/render_service.hpp"
#include "tests/support/fake_renderer.hpp"
#include "tests/support/head_counts.hpp"
#include "tests/support/serial_client.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;

/// A full turn in steps of 7.2 degrees with 20 bins of 48 mm, for quick lines.
micron::HeadCommand quick_scan() {
  micron::HeadCommand command;
  command.bins = 20;
  command.ad_interval = 100;
  command.step = 128;
  return command;
}

// One head and its client on one io_context that the test runs. The client has a socket or a tty of its own.
struct MicronHeadTest : testing::Test {
  asio::io_context io;
  SteadyClock clock;
  std::shared_ptr<test::FakeRendererControl> renderer = std::make_shared<test::FakeRendererControl>();
  PoseConfig pose_config;
  HeadConfig config = micron_type().make_default();
  MicronConfig micron_config;

  std::unique_ptr<PoseHistory> poses;
  std::unique_ptr<RenderService> service;
  std::unique_ptr<Head> head;
  std::optional<test::Client> connection;
  std::optional<micron::Client> client;
  std::vector<micron::ReceivedLine> lines;

  MicronHeadTest() {
    spdlog::set_level(spdlog::level::off);
    pose_config.T_world_vehicle_initial = render::Pose{};
    config.name = "head";
    micron_config.serial.tcp = {{{0x7F000001, 0}, {{0x7F000000, 8}}}};
    // Short times for quick tests.
    micron_config.device.boot_time = 10ms;
    micron_config.device.alive_period = 100ms;
    micron_config.device.reconfiguration_time = 10ms;
  }

  ~MicronHeadTest() override {
    if (head) {
      head->stop();
    }
    if (service) {
      service->stop();
    }
    spdlog::set_level(spdlog::level::info);
  }

  void start() {
    poses = std::make_unique<PoseHistory>(pose_config);
    RenderServiceHooks hooks;
    hooks.post = [this](std::function<void()> task) { asio::post(io, std::move(task)); };
    hooks.on_failure = [](const std::string& what) { FAIL() << what; };
    service = std::make_unique<RenderService>(test::fake_renderer_factory(renderer), 1, hooks);
    config.device = std::make_shared<MicronConfig>(micron_config);
    head = std::make_unique<Head>(config, 0, HeadServices{io, clock, *service, *poses, std::nullopt});
    head->start();
  }

  SerialAddresses addresses() const {
    return dynamic_cast<SerialTransport&>(head->connected().transport()).addresses();
  }

  void connect() {
    connection.emplace(test::Client::tcp(addresses().tcp.at(0)));
    consumed_ = 0;
    client.emplace(micron::ClientConfig{}, clock.now());
  }

  bool run_until(const std::function<bool()>& done, std::chrono::milliseconds limit = 20s) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!done() && std::chrono::steady_clock::now() < deadline) {
      io.run_one_for(2ms);
      io.restart();
      talk();
    }
    return done();
  }

  bool run_until_lines(std::size_t count) {
    return run_until([&] { return lines.size() >= count; });
  }

 private:
  /// Exchanges bytes between client and head, and collects lines.
  void talk() {
    if (!connection || !client) {
      return;
    }
    const test::Bytes& heard = connection->heard();
    client->on_bytes(clock.now(), std::span(heard).subspan(consumed_));
    consumed_ = heard.size();
    client->advance(clock.now());
    for (const auto& frame : client->take_outgoing()) {
      connection->write(frame);
    }
    for (micron::ReceivedLine& line : client->take_lines()) {
      lines.push_back(std::move(line));
    }
  }

  std::size_t consumed_ = 0;
};

TEST_F(MicronHeadTest, SendsWhatTheRendererHandedOver) {
  start();
  connect();
  client->start(clock.now(), quick_scan(), 12);
  ASSERT_TRUE(run_until_lines(12));
  for (std::size_t i = 0; i < 12; ++i) {
    ASSERT_EQ(lines[i].bins.size(), 20u);
    for (int bin = 0; bin < 20; ++bin) {
      EXPECT_EQ(lines[i].bins[static_cast<std::size_t>(bin)], test::fake_sample(i, bin, 0)) << i;
    }
  }
  EXPECT_GE(head->render_counters().pings_rendered, 12u);
}

TEST_F(MicronHeadTest, RendersOneBeamWhereTheVehicleTheMountAndTheHeadPoint) {
  const double half = std::sqrt(0.5);
  pose_config.T_world_vehicle_initial =
      render::Pose{{10, 0, -5}, glm::dquat(half, 0, 0, half)};  // bow to north
  config.T_vehicle_sonar.position_m = {1, 0, 0};
  config.seed = 77;
  start();
  connect();
  client->start(clock.now(), quick_scan(), 6);
  ASSERT_TRUE(run_until_lines(6));
  const std::vector<render::PingRequest> requests = renderer->recorded();
  for (std::size_t i = 0; i < 6; ++i) {
    const render::PingRequest& request = requests.at(i);
    EXPECT_EQ(request.settings.aperture.beam_count(), 1);
    EXPECT_EQ(request.settings.range.count, 20);
    EXPECT_NEAR(request.settings.range.step_m, 100 * 640e-9 * 750, 1e-12);
    EXPECT_EQ(request.settings.output_scale, render::OutputScale::half_decibels);
    EXPECT_EQ(request.seed, 77u);
    EXPECT_NEAR(glm::length(request.T_world_sonar.position_m - glm::dvec3(10, 1, -5)), 0, 1e-12);
    // The first ping looks ahead, to the north. Each ping is 7.2 degrees further to starboard, towards east.
    const double turned = static_cast<double>(i) * 7.2 * std::numbers::pi / 180;
    const glm::dvec3 axis = request.T_world_sonar.orientation * glm::dvec3(1, 0, 0);
    EXPECT_NEAR(glm::length(axis - glm::dvec3(std::sin(turned), std::cos(turned), 0)), 0, 1e-9) << i;
    EXPECT_EQ(lines[i].head.bearing, 3200 + 128 * i);
  }
}

// The ping listens for 20 bins of 100 x 640 ns.
TEST_F(MicronHeadTest, SaysWhereTheTransducerIsWhenTheLastEchoIsHeard) {
  pose_config.extrapolation_limit = 60s;
  start();
  pose::PoseSample sample;
  sample.time_ns = 1;
  sample.twist = pose::Velocity{{0, 0, 0}, {0, 0, 1.5}};
  poses->insert(sample, clock.now());
  connect();
  client->start(clock.now(), quick_scan(), 3);
  ASSERT_TRUE(run_until_lines(3));
  const render::PingRequest request = renderer->recorded().at(2);
  ASSERT_TRUE(request.T_world_sonar_at_end);
  const render::Pose moved = render::inverse(request.T_world_sonar) * *request.T_world_sonar_at_end;
  EXPECT_NEAR(glm::angle(moved.orientation), 1.5 * 20 * 100 * 640e-9, 1e-7);
  EXPECT_GT(moved.orientation.z, 0) << "to port";
}

TEST_F(MicronHeadTest, TheClientsGainMovesTheLevel) {
  start();
  connect();
  micron::HeadCommand loud = quick_scan();
  loud.gain = {210, 210};  // 80 dB
  client->start(clock.now(), loud, 2);
  ASSERT_TRUE(run_until_lines(2));
  EXPECT_NEAR(renderer->recorded().at(0).settings.physical.gain_db,
              config.acoustics.physical.gain_db + 80 - micron_config.nominal_gain_db, 1e-9);
}

TEST_F(MicronHeadTest, AClientThatVanishesInTheMiddleOfALineLeavesTheNextOneAClearLine) {
  start();
  connect();
  client->start(clock.now(), quick_scan(), 0);
  ASSERT_TRUE(run_until_lines(3));
  const test::Bytes half_a_command{'@', '0', '0', '3', 'C', 0x3C, 0x00, 0xFF, 0x02, 0x37, 0x13};
  connection->write(half_a_command);
  connection->reset();
  client.reset();
  ASSERT_TRUE(run_until([&] { return test::transport_count(*head, "connections") == 1 && service; }, 200ms));
  lines.clear();
  connect();
  // The head has kept its parameters and has turned further. It scans again at once, without a new power-up.
  client->start(clock.now(), quick_scan(), 5);
  ASSERT_TRUE(run_until_lines(5));
  EXPECT_EQ(test::device_count(*head, "bad_frames"), 0u);
  EXPECT_EQ(test::device_count(*head, "boots"), 0u);
}

TEST_F(MicronHeadTest, IsASerialDeviceTooAndAllClientsHearIt) {
  micron_config.serial.pty = {{}};
  start();
  test::Client listener = test::Client::tty(addresses().pty.at(0));
  connect();
  client->start(clock.now(), quick_scan(), 4);
  ASSERT_TRUE(run_until_lines(4));
  micron::Client second({}, clock.now());
  std::size_t consumed = 0;
  ASSERT_TRUE(run_until([&] {
    const test::Bytes& heard = listener.heard();
    second.on_bytes(clock.now(), std::span(heard).subspan(consumed));
    consumed = heard.size();
    return second.statistics().frames >= 4;
  }));
  EXPECT_GT(second.statistics().alives, 0u);
}

TEST_F(MicronHeadTest, WithoutAPoseItTurnsOnAndSendsNoLine) {
  pose_config.T_world_vehicle_initial.reset();
  start();
  connect();
  client->start(clock.now(), quick_scan(), 2);
  ASSERT_TRUE(run_until([&] { return head->render_counters().pings_without_pose >= 2; }));
  EXPECT_TRUE(lines.empty());
  EXPECT_EQ(head->render_counters().pings_rendered, 0u);
}

TEST_F(MicronHeadTest, APingThatCannotBeRenderedFailsAlone) {
  renderer->before_ping = [](const render::PingRequest& request, int) {
    if (request.ping_number == 1) {
      throw render::RequestError("not this one");
    }
  };
  start();
  connect();
  client->start(clock.now(), quick_scan(), 4);
  ASSERT_TRUE(run_until_lines(4));
  EXPECT_EQ(test::device_count(*head, "pings_failed"), 1u);
}

TEST_F(MicronHeadTest, StopsInTheMiddleOfAPing) {
  start();
  connect();
  client->start(clock.now(), quick_scan(), 0);
  ASSERT_TRUE(run_until([&] { return renderer->attempts > 0; }));
  head->stop();
  head.reset();
  service->stop();
  while (io.poll() > 0) {
    io.restart();  // posted tasks must not use the deleted head
  }
}

TEST_F(MicronHeadTest, AnAddressInUseIsNamed) {
  start();
  MicronConfig taken = micron_config;
  taken.serial.tcp[0].bind = addresses().tcp.at(0);
  HeadConfig other = config;
  other.device = std::make_shared<MicronConfig>(taken);
  try {
    const Head second(other, 0, HeadServices{io, clock, *service, *poses, std::nullopt});
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("127.0.0.1:"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sonard::server
