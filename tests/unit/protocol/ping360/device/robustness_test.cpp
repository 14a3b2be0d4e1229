// SPDX-License-Identifier: Apache-2.0
// No bytes from a peer make the head grow, stall or send without end. No missing peer stops it.
#include <random>

#include "bench.hpp"

namespace sonard::ping360 {
namespace {

TEST(Ping360Robustness, AClientThatVanishesTakesItsCommandsWithIt) {
  Bench bench;
  for (int angle = 1; angle < 4; ++angle) {
    bench.command(ping_at(angle), client_a);
  }
  bench.command(ping_at(9), client_b);
  bench.raw({'B', 'R', 14}, client_a);
  bench.step(ClientGone{client_a});
  bench.run_for(5s);
  ASSERT_EQ(bench.heard.size(), 1U);
  EXPECT_EQ(bench.heard[0].to, client_b);
  EXPECT_EQ(bench.ask(GeneralRequest{4}, client_a).size(), 1U) << "understood from its first byte on";
  bench.step(ClientGone{Peer{7, {1, 2}, 3}});
}

TEST(Ping360Robustness, AScanWithoutARendererTakesItsTime) {
  DeviceConfig config;
  config.time_scale = 0.0;
  Bench bench(config);
  bench.renderer_fails = true;
  bench.command(scan_of(7, 7));
  bench.run_for(1s);
  EXPECT_LE(bench.jobs.size(), 101U);
  EXPECT_GT(bench.jobs.size(), 50U);
}

TEST(Ping360Robustness, ClientsWithoutEndAreForgottenButTheOneThatListens) {
  Bench bench;
  bench.command(scan_of(0, 399), client_a);
  for (std::uint16_t port = 5000; port < 9000; ++port) {
    bench.raw({'B', 'R', 0xFF, 0x0F}, Peer{0, {0x0A000001, port}, 0});
  }
  EXPECT_EQ(bench.device.counters().clients_dropped, 4000U + 1 - 32);
  bench.heard.clear();
  bench.run_for(1s);
  EXPECT_FALSE(bench.all<AutoDeviceData>().empty());
}

TEST(Ping360Robustness, AFloodOfCommandsIsBoundedInOutput) {
  Bench bench;
  for (int i = 0; i < 20'000; ++i) {
    bench.command(ping_at(i % 400));
  }
  bench.run_for(20s);
  EXPECT_EQ(bench.heard.size(), 5U);
  bench.heard.clear();
  for (int i = 0; i < 2000; ++i) {
    bench.command(scan_of(i % 2, 399));
    bench.run_for(1ms);
  }
  EXPECT_TRUE(bench.heard.empty()) << "a head that is told something else all the time never gets ready";
}

TEST(Ping360Robustness, AFloodOfEqualCommandsIsOneCommand) {
  Bench bench;
  for (int i = 0; i < 20'000; ++i) {
    bench.raw(fixture("transducer"));
  }
  bench.run_for(20s);
  EXPECT_EQ(bench.heard.size(), 1U);
  bench.heard.clear();
  for (int i = 0; i < 2000; ++i) {
    bench.raw(fixture("auto_transmit"));
    bench.run_for(1ms);
  }
  // The head turns back for 1.2 s. A ping of 1024 samples of 2 us takes 26.1 ms.
  EXPECT_NEAR(static_cast<double>(bench.all<AutoDeviceData>().size()), (2.0 - 1.22) / 26.148e-3, 2.0);
  EXPECT_LE(
      std::ranges::count_if(bench.told(), [](const auto& it) { return it.starts_with("auto scan by"); }), 1);
}

TEST(Ping360Robustness, RefusalsAreToldOnceInTheLog) {
  Bench bench;
  Transducer command = ping_at(0);
  command.number_of_samples = 1250;
  for (int i = 0; i < 100; ++i) {
    bench.command(command);
  }
  EXPECT_EQ(bench.all<Nack>().size(), 100U);
  EXPECT_EQ(bench.notices.size(), 2U) << "connected, refused";
}

TEST(Ping360Robustness, RandomBytesAtRandomTimes) {
  const char* names[] = {"transducer",
                         "transducer_brping",
                         "transducer_pnarvor",
                         "auto_transmit",
                         "auto_transmit",
                         "request_device_data",
                         "motor_off",
                         "set_device_id",
                         "device_data",
                         "request_device_information",
                         "reset"};
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    const auto draw = [&](unsigned below) { return static_cast<unsigned>(random() % below); };
    DeviceConfig config = with_serial_line();
    config.fan_out = draw(2) == 0 ? FanOut::all : FanOut::requester;
    config.signed_scan_angles = draw(2) == 0;
    config.clamps_scan_to_stop = draw(2) == 0;
    config.time_scale = draw(3);
    config.reset_silence = std::chrono::milliseconds(draw(1000));
    Bench bench(config);
    bench.render_time = std::chrono::milliseconds(1 + draw(60));
    const Peer peers[] = {client_a, client_b, serial_client};
    for (int i = 0; i < 2000; ++i) {
      Bytes bytes = fixture(names[draw(draw(30) == 0 ? 11 : 10)]);
      for (unsigned flips = draw(3) == 0 ? draw(4) : 0; flips > 0; --flips) {
        bytes[draw(static_cast<unsigned>(bytes.size()))] = static_cast<std::uint8_t>(draw(256));
      }
      if (draw(10) == 0) {
        bytes.resize(draw(static_cast<unsigned>(bytes.size() + 1)));
      }
      bench.raw(bytes, peers[draw(3)]);
      bench.renderer_fails = draw(10) == 0;
      if (draw(100) == 0) {
        bench.step(ClientGone{peers[draw(3)]});
      }
      bench.run_for(std::chrono::microseconds(draw(100) == 0 ? draw(2'000'000) : draw(100'000)));
    }
    const DeviceCounters& counters = bench.device.counters();
    EXPECT_GT(counters.pings_sent, 10U);
    const std::uint64_t ended = counters.pings_sent + counters.pings_failed + counters.pings_cancelled;
    EXPECT_LE(ended, counters.pings_started);
    EXPECT_GE(ended + 1, counters.pings_started);
    EXPECT_EQ(bench.records.size(), counters.pings_sent);
  }
}

}  // namespace
}  // namespace sonard::ping360
