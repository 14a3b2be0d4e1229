// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/daemon.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "protocol/micron/client.hpp"
#include "server/clock/clock.hpp"
#include "server/daemon/exit_codes.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/micron/config.hpp"
#include "server/devices/micron/type.hpp"
#include "server/devices/playback.hpp"
#include "server/net/udp_endpoint.hpp"
#include "tests/support/fake_renderer.hpp"
#include "tests/support/loopback.hpp"
#include "tests/support/serial_client.hpp"
#include "tests/support/wait_for.hpp"

namespace sonard::server {
namespace {

using Bytes = std::vector<std::uint8_t>;

// The continuous form of the configuration in protocol/gemini/README.md 10, sonar ID 601: run mode 1, 32
// lines, one ping per 5 ms (the head's own limit may be slower).
Bytes continuous_config() {
  Bytes config(68);
  config[0] = 0x21;
  config[1] = 0x01;
  config[2] = 0x59;
  config[3] = 0x02;
  config[16] = 0x01;  // runMode
  config[18] = 0x04;  // 8 bit
  config[19] = 0x02;  // also out of water
  config[22] = 32;    // endRange
  config[24] = 0x88;  // 5000 us
  config[25] = 0x13;
  config[28] = 4;     // txLength
  config[48] = 0x98;  // 1500.0 m/s
  config[49] = 0x3A;
  config[50] = 0x01;
  return config;
}

// Runs serve() on this thread while `client` is the client on another thread.
struct DaemonTest : testing::Test {
  const Ipv4 head_address = test::own_loopback_address(2);
  const Ipv4 client_address = test::own_loopback_address(1);
  std::shared_ptr<test::FakeRendererControl> renderer = std::make_shared<test::FakeRendererControl>();
  DaemonConfig config;

  DaemonTest() {
    spdlog::set_level(spdlog::level::off);
    config.poses.T_world_vehicle_initial = render::Pose{};
    config.heads.push_back(head("first", 601, head_address));
  }
  ~DaemonTest() override { spdlog::set_level(spdlog::level::info); }

  HeadConfig head(const std::string& name, std::uint16_t id, Ipv4 address) const {
    auto device = std::make_shared<GeminiConfig>();
    device->device.sonar_id = id;
    device->device.alternate_address = address;
    device->device.netmask = 0xFF000000;
    device->device.min_ping_period = std::chrono::milliseconds{1};
    device->bind_address = address;
    device->status = {StatusDestination::Mode::unicast, {client_address}};
    device->allow = {{client_address, 32}};
    HeadConfig result = gemini_type().make_default();
    result.name = name;
    result.device = std::move(device);
    return result;
  }

  // A client that calls `react` for each datagram, until `react` returns true.
  static void play_client(UdpEndpoint& client, boost::asio::io_context& io,
                          const std::function<bool(const Datagram&)>& react) {
    bool done = false;
    client.start([&](const Datagram& datagram) { done = done || react(datagram); });
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{20};
    while (!done && std::chrono::steady_clock::now() < deadline) {
      io.run_one_for(std::chrono::milliseconds{10});
      io.restart();
    }
    EXPECT_TRUE(done) << "the daemon did not answer in time";
    client.close();
  }

  // Serves until `react` returns true. Then the client ends the daemon by a signal, as an operator does.
  int serve_until(const std::function<bool(UdpEndpoint&, const Datagram&)>& react, bool send_signal = true) {
    boost::asio::io_context io;
    UdpEndpoint client(io, {client_address, 52900});
    std::thread playing([&] {
      play_client(client, io, [&](const Datagram& datagram) { return react(client, datagram); });
      if (send_signal) {
        kill(getpid(), SIGTERM);
      }
    });
    const int code = serve(config, {}, test::fake_renderer_factory(renderer));
    playing.join();
    return code;
  }
};

bool is(const Datagram& datagram, std::uint8_t type) {
  return datagram.bytes[0] == type;
}

TEST_F(DaemonTest, EndsCleanlyOnASignal) {
  EXPECT_EQ(serve_until([](UdpEndpoint&, const Datagram& datagram) { return is(datagram, 0x40); }),
            exit_clean);
  EXPECT_TRUE(renderer->destroyed);
}

// The ping has usual settings and the pose of vehicle and mount. It is rendered before the daemon serves.
TEST_F(DaemonTest, RendersAPingOfEachHeadThatNobodyGetsBeforeItIsReady) {
  HeadConfig mounted = head("mounted", 602, test::own_loopback_address(3));
  mounted.T_vehicle_sonar.position_m = {1, 2, 3};
  config.heads.push_back(mounted);
  config.poses.T_world_vehicle_initial = render::Pose{{10, 20, 30}, {1, 0, 0, 0}};
  std::vector<std::pair<int, render::PingRequest>> warmed;
  renderer->warming_up = [&](const render::PingRequest& request, int head) {
    EXPECT_EQ(renderer->attempts, 0);
    warmed.emplace_back(head, request);
  };
  serve_until([](UdpEndpoint&, const Datagram& datagram) { return is(datagram, 0x40); });
  ASSERT_EQ(warmed.size(), 2U);
  EXPECT_EQ(warmed[0].first, 0);
  EXPECT_EQ(warmed[1].first, 1);
  EXPECT_EQ(warmed[0].second.settings.aperture.beam_count(), 256);
  EXPECT_NEAR(warmed[0].second.settings.range.max_range_m(), 20.0, 0.01);
  EXPECT_EQ(warmed[1].second.T_world_sonar.position_m, glm::dvec3(11, 22, 33));
  EXPECT_EQ(renderer->attempts, 0) << "no ping of a client";
}

TEST_F(DaemonTest, RendererThatFailsToWarmUpIsReportedBeforeAnythingIsServed) {
  renderer->warming_up = [](const render::PingRequest&, int) { throw render::RendererError("no shaders"); };
  EXPECT_THROW(serve(config, {}, test::fake_renderer_factory(renderer)), render::RendererError);
}

TEST_F(DaemonTest, ServesSeveralHeads) {
  const Ipv4 second_address = test::own_loopback_address(3);
  config.heads.push_back(head("second", 602, second_address));
  bool first = false;
  bool second = false;
  const int code = serve_until([&](UdpEndpoint&, const Datagram& datagram) {
    first = first || datagram.remote.address == head_address;
    second = second || datagram.remote.address == second_address;
    return first && second;
  });
  EXPECT_EQ(code, exit_clean);
}

// A Micron's lines take 24 ms each, although the renderer is busy for seconds with one multibeam ping.
TEST_F(DaemonTest, AScanningHeadDoesNotWaitForAFan) {
  auto serial = std::make_shared<MicronConfig>();
  serial->serial.tcp = {{{head_address, 4001}, {{0x7F000000, 8}}}};
  HeadConfig scanning = micron_type().make_default();
  scanning.name = "micron";
  scanning.device = std::move(serial);
  config.heads.push_back(scanning);
  std::atomic<bool> fan_is_busy{false}, lines_are_here{false};
  renderer->before_ping = [&](const render::PingRequest& request, int) {
    if (request.settings.aperture.beam_count() > 1) {
      fan_is_busy = true;
      EXPECT_TRUE(test::wait_for([&] { return lines_are_here.load(); }));
    }
  };
  std::thread scan([&] {
    ASSERT_TRUE(test::wait_for([&] { return fan_is_busy.load(); }));
    const SteadyClock clock;
    test::Client connection = test::Client::tcp({head_address, 4001});
    micron::Client client({}, clock.now());
    client.start(clock.now(), {}, 20);
    std::size_t consumed = 0;
    EXPECT_TRUE(test::wait_for([&] {
      const test::Bytes& heard = connection.heard();
      client.on_bytes(clock.now(), std::span(heard).subspan(consumed));
      consumed = heard.size();
      client.advance(clock.now());
      for (const auto& frame : client.take_outgoing()) {
        connection.write(frame);
      }
      return client.finished();
    }));
    lines_are_here = true;
  });
  const int code = serve_until([&](UdpEndpoint& client, const Datagram& datagram) {
    if (is(datagram, 0x40) && !fan_is_busy) {
      client.send({{{head_address, 52901}, 0, SharedBytes(continuous_config())}});
    }
    return lines_are_here.load() && is(datagram, 0x43);
  });
  scan.join();
  EXPECT_EQ(code, exit_clean);
}

/// The metrics of a page.
std::string metrics_at(const Endpoint& page) {
  boost::asio::ip::tcp::iostream stream;
  stream.expires_after(std::chrono::seconds{10});
  stream.connect(boost::asio::ip::tcp::endpoint(boost::asio::ip::address_v4(page.address), page.port));
  stream << "GET /metrics HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n" << std::flush;
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST_F(DaemonTest, MetricsNameTheEngineOfTheNewestPing) {
  config.web = WebConfig{};
  config.web->bind = {test::own_loopback_address(3), 8052};
  config.web->allow = {{0x7F000000, 8}};
  renderer->before_ping = [this](const render::PingRequest&, int) {
    renderer->engine = "cpu, because the GPU is lost";
  };
  const std::string gpu_lost = "engine=\"cpu, because the GPU is lost\"} 1";
  std::string before, after;
  const int code = serve_until([&](UdpEndpoint& client, const Datagram& datagram) {
    if (is(datagram, 0x40) && before.empty()) {
      before = metrics_at(config.web->bind);
      client.send({{{head_address, 52901}, 0, SharedBytes(continuous_config())}});
    } else if (is(datagram, 0x43)) {
      after = metrics_at(config.web->bind);
    }
    return after.find(gpu_lost) != std::string::npos;  // the page keeps a status for a moment
  });
  EXPECT_EQ(code, exit_clean);
  EXPECT_NE(before.find("engine=\"fake\"} 1"), std::string::npos) << before;
  EXPECT_NE(after.find(gpu_lost), std::string::npos) << after;
}

TEST_F(DaemonTest, RendererThatFailsWhileServingEndsItWithItsOwnCode) {
  renderer->before_ping = [](const render::PingRequest&, int) {
    throw render::RendererError("context lost");
  };
  const int code = serve_until(
      [this](UdpEndpoint& client, const Datagram&) {
        client.send({{{head_address, 52901}, 0, SharedBytes(continuous_config())}});
        return true;
      },
      /*send_signal=*/false);
  EXPECT_EQ(code, exit_renderer);
  EXPECT_EQ(renderer->attempts, 1);
}

TEST_F(DaemonTest, AddressInUseNamesTheKey) {
  boost::asio::io_context io;
  const UdpEndpoint squatter(io, {head_address, 52901});
  try {
    serve(config, {}, test::fake_renderer_factory(renderer));
    FAIL() << "no exception";
  } catch (const Error& error) {
    EXPECT_EQ(error.where, "heads[0].network.bind");
    EXPECT_EQ(exit_code_of(error.kind), exit_network);
  }
}

TEST_F(DaemonTest, RendererThatCannotBeMadeIsReportedBeforeAnythingIsServed) {
  const RendererFactory failing = []() -> std::unique_ptr<PingRenderer> {
    throw render::RendererError("no GL");
  };
  EXPECT_THROW(serve(config, {}, failing), render::RendererError);
}

// For the thread sanitizer: the signal comes while the head pings at its highest rate.
TEST_F(DaemonTest, EndsCleanlyInTheMiddleOfPings) {
  for (int life = 0; life < 50; ++life) {
    int heads = 0;
    const auto started = std::chrono::steady_clock::now();
    const int code = serve_until([&](UdpEndpoint& client, const Datagram& datagram) {
      if (is(datagram, 0x40)) {
        client.send({{{head_address, 52901}, 0, SharedBytes(continuous_config())}});
      }
      heads += is(datagram, 0x41) ? 1 : 0;
      return heads > life % 3;
    });
    ASSERT_EQ(code, exit_clean) << "life " << life;
    ASSERT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds{10}) << "life " << life;
  }
}

/// An endless recording without pings, and an I/O thread that is busy when the signal to end comes.
class BusyPlayback final : public Playback {
 public:
  std::optional<ReplayedPing> next_ping(int, TimePoint now) override {
    first_ = std::min(first_, now);
    if (!ended_ && now - first_ > std::chrono::milliseconds{500}) {
      ended_ = true;
      kill(getpid(), SIGTERM);
      // Long enough for the daemon's timers to expire. Their handlers then run after the shutdown.
      std::this_thread::sleep_for(std::chrono::milliseconds{2500});
    }
    return std::nullopt;
  }
  void started(int, const PingJob&) override {}
  void progress(int, TimePoint, const PingProgress&) override {}
  bool finished(TimePoint) const override { return false; }

 private:
  TimePoint first_ = TimePoint::max();
  bool ended_ = false;
};

TEST_F(DaemonTest, EndsThoughTimersHaveRunOutMeanwhile) {
  BusyPlayback playback;
  alarm(60);  // ends the test if the daemon hangs
  EXPECT_EQ(serve(config, {}, test::fake_renderer_factory(renderer), &playback), exit_clean);
  alarm(0);
}

}  // namespace
}  // namespace sonard::server
