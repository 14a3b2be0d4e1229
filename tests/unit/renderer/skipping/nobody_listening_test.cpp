// SPDX-License-Identifier: Apache-2.0
// A ping that is cancelled while the renderer is busy with another head is not rendered at all.
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "server/devices/device_type.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/head.hpp"
#include "server/devices/head_rendering.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/pose/pose_history.hpp"
#include "server/rendering/render_service.hpp"
#include "tests/support/fake_renderer.hpp"
#include "tests/support/loopback.hpp"

namespace sonard::server {
namespace {

using Bytes = std::vector<std::uint8_t>;

// protocol/gemini/README.md 10, for sonar ID 601: single ping, 8 bit, 483 lines.
const Bytes ping_config{0x21, 0x01, 0x59, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                        0x00, 0x00, 0x00, 0x00, 0x04, 0x02, 0x00, 0x00, 0xe3, 0x01, 0x40, 0x0d, 0x03, 0x00,
                        0x04, 0x00, 0x00, 0x00, 0xe8, 0x83, 0x00, 0x00, 0x00, 0x1e, 0x00, 0x00, 0x43, 0x00,
                        0x00, 0x00, 0x07, 0x00, 0x01, 0x00, 0x90, 0x3a, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00,
                        0x00, 0x00, 0x00, 0x00, 0x01, 0x1d, 0x00, 0x00, 0x01, 0x12, 0x1e, 0x11};
constexpr std::uint8_t tail_type = 0x43;
constexpr int other_head = 1;

Bytes reboot_command() {
  gemini::Reboot reboot;
  reboot.header.sonar_id = 601;
  return gemini::encode(gemini::Command{reboot});
}

const gemini::DeviceCounters& device_counters(Head& head) {
  return dynamic_cast<const gemini::Device&>(head.connected().device()).counters();
}
std::uint64_t started(Head& head) {
  return device_counters(head).pings_started;
}
std::uint64_t cancelled(Head& head) {
  return device_counters(head).pings_cancelled;
}

/// A head on head 0, and the render thread held up by a ping of another head until release().
class NobodyListening : public testing::Test {
 protected:
  NobodyListening() {
    config_.name = "head";
    gemini_.device.sonar_id = 601;
    gemini_.device.alternate_address = head_address_;
    gemini_.device.netmask = 0xFF000000;
    gemini_.device.reboot_time = std::chrono::milliseconds{1};
    gemini_.bind_address = head_address_;
    gemini_.status = {StatusDestination::Mode::unicast, {client_address_}};
    gemini_.allow = {{client_address_, 32}};
    client_.start([this](const Datagram& datagram) { received_.push_back(datagram); });
  }

  ~NobodyListening() override {
    release();
    if (head_) {
      head_->stop();
    }
    if (service_) {
      service_->stop();
    }
  }

  void start(const render::SkipSwitches& skip) {
    renderer_->before_ping = [released = release_.get_future().share()](const render::PingRequest&,
                                                                        int head) {
      if (head == other_head) {
        released.wait_for(std::chrono::seconds{20});
      }
    };
    RenderServiceHooks hooks;
    hooks.post = [this](std::function<void()> task) { boost::asio::post(io_, std::move(task)); };
    hooks.on_failure = [](const std::string& what) { FAIL() << what; };
    service_ = std::make_unique<RenderService>(test::fake_renderer_factory(renderer_), 2, hooks);
    const HeadServices services{io_, clock_, *service_, poses_, std::nullopt, skip};
    config_.device = std::make_shared<GeminiConfig>(gemini_);
    head_ = std::make_unique<Head>(config_, 0, services);
    head_->start();
    PosedPing job;
    job.head = other_head;
    job.request.settings.aperture.beam_edges_rad = {0.1, -0.1};
    service_->submit(std::move(job), [this](const RenderResult&) { other_done_ = true; });
  }

  void release() {
    if (!released_) {
      released_ = true;
      release_.set_value();
    }
  }

  void command(const Bytes& bytes) { client_.send({{{head_address_, 52901}, 0, SharedBytes(bytes)}}); }

  std::vector<Bytes> datagrams_of_pings() const {
    std::vector<Bytes> found;
    for (const Datagram& datagram : received_) {
      if (datagram.bytes.size() > 0 && datagram.bytes[0] >= 0x41 && datagram.bytes[0] <= tail_type) {
        found.emplace_back(datagram.bytes.begin(), datagram.bytes.end());
      }
    }
    return found;
  }

  bool run_until(const std::function<bool()>& done) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    while (!done() && std::chrono::steady_clock::now() < deadline) {
      io_.run_one_for(std::chrono::milliseconds{10});
      io_.restart();
    }
    return done();
  }

  /// Requests a ping and cancels it by a reboot before its turn; then frees the renderer.
  void cancel_a_ping() {
    ASSERT_TRUE(run_until([&] { return renderer_->attempts == 1; }));
    command(ping_config);
    ASSERT_TRUE(run_until([&] { return started(*head_) == 1; }));
    command(reboot_command());
    ASSERT_TRUE(run_until([&] { return cancelled(*head_) == 1; }));
    release();
    ASSERT_TRUE(run_until([&] { return other_done_; }));
  }

  /// Lines of the next ping that a client receives, without head and tail, which hold times.
  std::vector<Bytes> lines_of_next_ping() {
    std::vector<Bytes> lines;
    const auto complete = [&] {
      const std::vector<Bytes> all = datagrams_of_pings();
      return !all.empty() && all.back()[0] == tail_type;
    };
    std::this_thread::sleep_for(2 * gemini_.device.reboot_time);
    command(ping_config);
    EXPECT_TRUE(run_until(complete));
    for (Bytes& bytes : datagrams_of_pings()) {
      if (bytes[0] == 0x42) {
        lines.push_back(std::move(bytes));
      }
    }
    return lines;
  }

  /// With the rule on or off a client receives only the ping that was not cancelled, number 1 from 0.
  static void expect_second_ping(const std::vector<Bytes>& lines) {
    ASSERT_EQ(lines.size(), 483u);
    for (int line = 0; line < 483; ++line) {
      ASSERT_EQ(lines[static_cast<std::size_t>(line)].at(16), test::fake_sample(1, line, 0));
    }
  }

  bool withdraws_the_ping_being_rendered() {
    EXPECT_TRUE(run_until([&] { return renderer_->attempts == 1; }));
    return service_->withdraw(other_head);
  }

  std::uint64_t skipped() const {
    return head_->render_counters().skipped.of(render::SkipRule::nobody_listening);
  }
  std::size_t pings_rendered_for_the_head() const { return renderer_->recorded().size() - 1; }

 private:
  const Ipv4 head_address_ = test::own_loopback_address(2);
  const Ipv4 client_address_ = test::own_loopback_address(1);
  boost::asio::io_context io_;
  SteadyClock clock_;
  std::shared_ptr<test::FakeRendererControl> renderer_ = std::make_shared<test::FakeRendererControl>();
  PoseConfig pose_config_ = [] {
    PoseConfig poses;
    poses.T_world_vehicle_initial = render::Pose{};
    return poses;
  }();
  PoseHistory poses_{pose_config_};
  HeadConfig config_ = gemini_type().make_default();
  GeminiConfig gemini_;
  std::promise<void> release_;
  bool released_ = false;
  bool other_done_ = false;
  std::unique_ptr<RenderService> service_;
  std::unique_ptr<Head> head_;
  UdpEndpoint client_{io_, {client_address_, 52900}};
  std::vector<Datagram> received_;
};

TEST_F(NobodyListening, PingCalledOffBeforeItsTurnIsNotRendered) {
  start({});
  cancel_a_ping();
  EXPECT_EQ(skipped(), 1u);
  const std::vector<Bytes> lines = lines_of_next_ping();
  expect_second_ping(lines);
  EXPECT_EQ(pings_rendered_for_the_head(), 1u);
  EXPECT_EQ(skipped(), 1u);
}

TEST_F(NobodyListening, SwitchedOffItIsRenderedAndThrownAway) {
  start(render::SkipSwitches{}.turn_off(render::SkipRule::nobody_listening));
  cancel_a_ping();
  EXPECT_EQ(skipped(), 0u);
  const std::vector<Bytes> lines = lines_of_next_ping();
  expect_second_ping(lines);
  EXPECT_EQ(pings_rendered_for_the_head(), 2u);
  EXPECT_EQ(skipped(), 0u);
}

TEST_F(NobodyListening, JobThatHasBegunIsNotWithdrawn) {
  start({});
  EXPECT_FALSE(withdraws_the_ping_being_rendered());
}

}  // namespace
}  // namespace sonard::server
