// SPDX-License-Identifier: Apache-2.0
// Stopping the page's server.
#include "server/web/web_server.hpp"

#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

TEST(WebServer, StopDoesNotWaitForWhatIsQueued) {
  WebConfig config;
  config.bind = {0x7F000001, 0};
  const render::World world;
  WebServer server(config);
  server.start({.ask_status = [](const auto&) {}, .turn_recording = nullptr, .identity = {}, .world = world});
  constexpr int queued = 200;
  std::atomic<int> ran{0};
  for (int i = 0; i < queued; ++i) {
    server.on_page([&ran] {
      std::this_thread::sleep_for(std::chrono::milliseconds{50});
      ++ran;
    });
  }
  server.stop();
  EXPECT_LT(ran, queued);
}

}  // namespace
}  // namespace sonard::server
