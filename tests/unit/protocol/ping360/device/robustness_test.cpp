// SPDX-License-Identifier: Apache-2.0
// No bytes from a peer make the head grow, stall or send without end. No missing peer stops it.
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

}  // namespace
}  // namespace sonard::ping360
