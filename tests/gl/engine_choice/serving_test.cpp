// SPDX-License-Identifier: Apache-2.0
// If the OpenGL context is destroyed while a daemon serves, the client loses at most one ping.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <boost/asio/io_context.hpp>

#include "protocol/gemini/client.hpp"
#include "server/clock/clock.hpp"
#include "server/daemon/daemon.hpp"
#include "server/daemon/exit_codes.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/rendering/world_renderer.hpp"
#include "tests/gl/engine_choice/wall_and_ball.hpp"
#include "tests/support/engine_test.hpp"
#include "tests/support/loopback.hpp"

namespace sonard::server {
namespace {

constexpr std::uint64_t wanted_pings = 12;

/// A head in front of a wall; a client requests its pings.
class ServingWithoutGpu : public testing::Test {
 protected:
  void SetUp() override {
    test::require_gl();
    spdlog::set_level(spdlog::level::off);
    auto device = std::make_shared<GeminiConfig>();
    device->device.sonar_id = 601;
    device->device.alternate_address = head_address_;
    device->device.netmask = 0xFF000000;
    device->bind_address = head_address_;
    device->status = {StatusDestination::Mode::unicast, {client_address_}};
    device->allow = {{client_address_, 32}};
    HeadConfig head = gemini_type().make_default();
    head.name = "head";
    head.device = std::move(device);
    config_.heads.push_back(head);
    config_.poses.T_world_vehicle_initial = render::Pose{};
  }
  void TearDown() override { spdlog::set_level(spdlog::level::info); }

  /// Receives pings until all have arrived, for at most 120 s; then ends the daemon.
  void play_client() {
    boost::asio::io_context io;
    const SteadyClock clock;
    gemini::Client client({601, head_address_});
    UdpEndpoint socket(io, {client_address_, 52900});
    socket.start([&](const Datagram& datagram) { client.on_datagram(clock.now(), datagram.bytes); });
    gemini::PingConfig config;
    config.run_mode = static_cast<std::uint16_t>(gemini::RunMode::continuous);
    config.ext_mode = gemini::ext_bits::eight_bit | gemini::ext_bits::ping_out_of_water;
    config.end_range = 1100;
    client.start(clock.now(), config, wanted_pings);
    const TimePoint last = clock.now() + std::chrono::seconds{120};
    while (pings_.size() < wanted_pings && clock.now() < last) {
      client.advance(clock.now());
      for (const gemini::ClientDatagram& datagram : client.take_outgoing()) {
        socket.send({{{datagram.to, 52901}, 0, SharedBytes(datagram.bytes)}});
      }
      for (gemini::ReceivedPing& ping : client.take_pings()) {
        pings_.push_back(std::move(ping));
      }
      io.run_one_for(std::chrono::milliseconds{5});
      io.restart();
    }
    statistics_ = client.statistics();
    socket.close();
    kill(getpid(), SIGTERM);
  }

  const Ipv4 head_address_ = test::own_loopback_address(2);
  const Ipv4 client_address_ = test::own_loopback_address(1);
  DaemonConfig config_;
  std::vector<gemini::ReceivedPing> pings_;
  gemini::LinkStatistics statistics_;
};

TEST_F(ServingWithoutGpu, LosesOnePingAtMost) {
  const render::World world = test::make_world({test::wall_ahead()});
  std::vector<std::string> lines;
  render::RendererOptions options = renderer_options(config_);
  options.engine = render::EngineKind::gpu;
  options.gpu.lose_context_at_image = 5;                     // the first is made at the start
  options.skip.turn_off(render::SkipRule::unchanged_scene);  // the sonar rests, but every ping is an image
  options.report = [&](const std::string& line) { lines.push_back(line); };
  std::thread client([this] { play_client(); });
  const int code = serve(config_, world, world_renderer_factory(world, options, {}));
  client.join();
  EXPECT_EQ(code, exit_clean);
  EXPECT_EQ(lines.size(), 1U);
  EXPECT_EQ(pings_.size(), wanted_pings);
  EXPECT_LE(statistics_.pings_missed + statistics_.pings_abandoned + statistics_.pings_incomplete, 1U);
  for (const gemini::ReceivedPing& ping : pings_) {
    EXPECT_TRUE(ping.complete());
    const auto& samples = ping.samples.u8;
    EXPECT_GT(std::count_if(samples.begin(), samples.end(), [](std::uint8_t value) { return value > 0; }),
              100)
        << "ping " << ping.number << " shows no wall";
  }
}

}  // namespace
}  // namespace sonard::server
