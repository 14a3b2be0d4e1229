// SPDX-License-Identifier: Apache-2.0
// S11, S15, S18 and S20 of tests/gl/stability/README.md: counters, times, warnings, a lost context and a slow
// renderer in a daemon that serves for months.
#include <unistd.h>
#include <algorithm>

#include <chrono>
#include <cmath>
#include <deque>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/pose/pose_history.hpp"
#include "server/rendering/render_service.hpp"
#include "tests/unit/protocol/gemini/device/bench.hpp"
#include "tests/unit/server/config/config_text.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;
using gemini::Bench;

PingImage blank_image(const PingJob& job) {
  PingImage image;
  image.number = job.number;
  image.u8.assign(static_cast<std::size_t>(job.bins()) * gemini::beam_count, 0);
  return image;
}

// More pings than 16 bits count. A job's number goes on; its number on the wire wraps at 256.
TEST(LongRun, S11PingNumbersWrapOnTheWireOnly) {
  constexpr std::uint64_t pings = 70'000;
  gemini::DeviceConfig config = gemini::example_config();
  config.min_ping_period = 1ms;
  Bench bench(config);
  bench.render = blank_image;
  std::uint64_t heads = 0;
  bench.on_sent = [&](const Bench::Sent& datagram) {
    if (datagram.type() != static_cast<std::uint8_t>(gemini::MessageType::ping_head)) {
      return;
    }
    const auto report = gemini::decode_report(datagram.bytes);
    ASSERT_TRUE(report);
    ASSERT_EQ(std::get<gemini::PingHead>(*report).ping_id, heads % 256);
    ++heads;
  };
  bench.command(gemini::ping_of(32, gemini::RunMode::continuous, 1ms));
  std::uint64_t jobs = 0;
  while (jobs < pings && bench.now < 10min) {
    bench.run_connected(1s);
    for (const PingJob& job : bench.jobs) {
      ASSERT_EQ(job.number, jobs);
      ++jobs;
    }
    bench.jobs.clear();
    bench.sent.clear();
  }
  EXPECT_GE(jobs, pings);
  EXPECT_GE(heads + 1, jobs);
}

// 2^31 ms are 25 days, 2^32 ms 50, and 2^32 us 72 minutes: times stay exact across all of them. By then
// seconds in float would step in milliseconds.
TEST(LongRun, S11TimesBeyondTwoToTheThirtyOneMilliseconds) {
  gemini::DeviceConfig config = gemini::example_config();
  config.status_period = 60s;
  Bench bench(config);
  bench.render = blank_image;
  for (const std::chrono::microseconds seam :
       {std::chrono::microseconds{std::int64_t{1} << 32},
        std::chrono::microseconds{std::chrono::milliseconds{std::int64_t{1} << 31}},
        std::chrono::microseconds{std::chrono::milliseconds{std::int64_t{1} << 32}}}) {
    while (bench.now < seam - 1h) {
      bench.run_for(1h);
      bench.sent.clear();
    }
    bench.run_until(seam - 50ms);
    bench.sent.clear();
    bench.command(gemini::ping_of(32, gemini::RunMode::continuous, 40ms));
    bench.run_for(200ms);
    const auto heads = bench.all<gemini::PingHead>();
    ASSERT_GE(heads.size(), 4U);
    for (std::size_t i = 0; i < heads.size(); ++i) {
      // 50, 10 ms before the seam, 30 after, ...
      const auto transmit_us = static_cast<std::uint64_t>(seam.count()) - 50'000 + 40'000 * i;
      EXPECT_EQ(heads[i].second.transmit_time_us, transmit_us);
    }
    bench.command(gemini::ping_of(32));  // one last ping, then silence
    bench.run_for(10s);
  }
}

// A year on the publisher's clock, in nanoseconds and double metres: poses are interpolated as at the start.
// Then the clock is set back by the year, as when a simulation is reset, and poses follow at once.
TEST(LongRun, S11PosesAfterAYearAndWithTheClockSetBack) {
  PoseHistory history{PoseConfig{}};
  constexpr std::int64_t year_ns = 365LL * 24 * 3600 * 1'000'000'000;
  TimePoint arrival = 1000s;
  const auto check_around = [&](std::int64_t start_ns) {
    const TimePoint begin = arrival;
    for (int i = 0; i <= 10; ++i) {
      pose::PoseSample sample;
      sample.time_ns = start_ns + i * 20'000'000LL;
      sample.T_world_vehicle.position_m = {0.03 * i, 0, 0};  // 1.5 m/s
      arrival = begin + i * 20ms;
      history.insert(sample, arrival);
    }
    for (const double ms : {1.0, 50.5, 199.0}) {
      const auto estimate = history.at(begin + std::chrono::nanoseconds{static_cast<std::int64_t>(ms * 1e6)});
      ASSERT_TRUE(estimate);
      EXPECT_NEAR(estimate->T_world_vehicle.position_m.x, 1.5e-3 * ms, 1e-12) << start_ns;
    }
    arrival += 1s;
  };
  check_around(year_ns);
  EXPECT_EQ(history.counters().clock_restarts, 0U);
  check_around(0);
  EXPECT_EQ(history.counters().clock_restarts, 1U);
  check_around(-year_ns);
  EXPECT_EQ(history.counters().clock_restarts, 2U);
}

using Water = ConfigFolder;

// Absorption outside the range of its formula causes one warning, with any number of heads.
TEST_F(Water, S15OutsideTheFormulaIsWarnedOfOnce) {
  const std::string second_head =
      "  - name: aft\n    type: gemini_720i\n    sonar_id: 514\n"
      "    network: {alternate_address: 127.0.0.3, netmask: 255.0.0.0}\n";
  EXPECT_TRUE(load(minimal_config).warning_lines().empty());
  for (const char* water :
       {"salinity_ppt: 0", "salinity_ppt: 50", "temperature_c: -4", "temperature_c: 45"}) {
    const LoadedConfig loaded = load(minimal_config + second_head + "water: {" + water + "}\n");
    ASSERT_EQ(loaded.warning_lines().size(), 1U) << water;
    EXPECT_NE(loaded.warning_lines()[0].find("water"), std::string::npos) << loaded.warning_lines()[0];
    for (const HeadConfig& head : loaded.config.heads) {
      const double absorption = head.acoustics.physical.absorption_db_per_m;
      EXPECT_TRUE(std::isfinite(absorption) && absorption > 0 && absorption < 1) << water;
    }
  }
  EXPECT_TRUE(
      load(minimal_config + "water: {salinity_ppt: 0, absorption_db_per_km: 161}\n").warning_lines().empty())
      << "a number that is given outright is nobody's extrapolation";
}

/// The I/O thread: runs the tasks that the render thread has posted.
class Inbox {
 public:
  Post post() {
    return [this](std::function<void()> task) {
      const std::lock_guard lock(mutex_);
      tasks_.push_back(std::move(task));
      most_ = std::max(most_, tasks_.size());
    };
  }
  /// @return false if `done` is not true within ten seconds.
  bool run_until(const std::function<bool()>& done) {
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    while (!done() && std::chrono::steady_clock::now() < deadline) {
      run();
      std::this_thread::yield();
    }
    return done();
  }
  std::size_t most() const { return most_; }

 private:
  void run() {
    std::deque<std::function<void()>> tasks;
    {
      const std::lock_guard lock(mutex_);
      tasks.swap(tasks_);
    }
    for (const auto& task : tasks) {
      task();
    }
  }

  std::mutex mutex_;
  std::deque<std::function<void()>> tasks_;
  std::size_t most_ = 0;
};

/// Runs a script in place of rendering.
class ScriptedRenderer final : public PingRenderer {
 public:
  using Script = std::function<void(const render::PingRequest&)>;
  explicit ScriptedRenderer(Script script) : script_(std::move(script)) {}

  std::string description() const override { return "scripted"; }
  bool set_body_pose(const std::string&, const render::Pose&) override { return true; }
  render::PingSamples render_ping(const render::PingRequest& request, int) override {
    script_(request);
    render::PingSamples samples;
    samples.beams = request.settings.aperture.beam_count();
    samples.bins = request.settings.range.output_count();
    samples.u8.assign(static_cast<std::size_t>(samples.beams) * static_cast<std::size_t>(samples.bins), 1);
    return samples;
  }
  render::PingStatistics last_statistics() const override { return {}; }

 private:
  Script script_;
};

/// A device, a pose history and a render service in virtual time, joined as Head joins them.
class VirtualDaemon {
 public:
  static constexpr auto render_time = 1s;  // ten times the requested ping period

  VirtualDaemon(const ScriptedRenderer::Script& script, std::function<void(const std::string&)> on_failure)
      : device_(gemini::example_config(), 0ns), poses_(pose_config()) {
    RenderServiceHooks hooks;
    hooks.post = inbox_.post();
    hooks.on_failure = std::move(on_failure);
    service_ =
        std::make_unique<RenderService>([&] { return std::make_unique<ScriptedRenderer>(script); }, 1, hooks);
    move_vehicle();
    command(gemini::ping_of(32, gemini::RunMode::continuous, 100ms));
  }

  /// The vehicle moves with 1 m/s along x, so that x is the time of a pose in seconds; ten poses a second.
  void run_until(TimePoint end) {
    while (now_ < end && !failed) {
      now_ += 100ms;
      move_vehicle();
      if (now_ % 1s == 0s) {
        command(gemini::to_head<gemini::StatusRequest>());
      }
      step();
    }
  }

  TimePoint now() const { return now_; }
  RenderService& service() { return *service_; }
  Inbox& inbox() { return inbox_; }

  bool failed = false;
  std::uint64_t pings = 0, dropped = 0, datagrams = 0;
  double oldest_pose_s = 0;  ///< at transmit time

 private:
  static PoseConfig pose_config() {
    PoseConfig config;
    config.extrapolation_limit = 200ms;
    return config;
  }

  void move_vehicle() {
    pose::PoseSample sample;
    sample.time_ns = now_.count();
    sample.T_world_vehicle.position_m.x = std::chrono::duration<double>(now_).count();
    poses_.insert(sample, now_);
  }

  void command(const gemini::Command& message) {
    happen(BytesReceived{{0, {gemini::client_address, gemini::client_port}, gemini::head_address},
                         SharedBytes(gemini::encode(message))});
  }

  void step() {
    if (!answer_ || answer_->first > now_) {
      happen(TimePassed{});
      return;
    }
    const auto [number, result] = std::exchange(answer_, std::nullopt)->second;
    if (result.error.empty()) {
      ++pings;
      happen(PingRendered{{number, result.samples.u8, result.samples.u16}});
    } else {
      ++dropped;
      happen(PingNotRendered{number});
    }
  }

  void happen(const Event& event) {
    const Actions actions = device_.step(now_, event);
    datagrams += actions.send.size();
    if (actions.render) {
      submit(*actions.render);
    }
  }

  void submit(const PingJob& job) {
    const auto pose = poses_.at(job.transmit_time);
    ASSERT_TRUE(pose);
    PosedPing render;
    render.request.T_world_sonar = pose->T_world_vehicle;
    render.request.ping_number = job.number;
    render.request.settings.aperture.beam_edges_rad = render::equal_sine_edges(gemini::beam_count, 1.0);
    render.request.settings.range = {job.native_bins, job.native_bin_m, 0, false};
    oldest_pose_s = std::max(oldest_pose_s, std::chrono::duration<double>(job.transmit_time).count() -
                                                pose->T_world_vehicle.position_m.x);
    std::optional<RenderResult> result;
    service_->submit(std::move(render), [&](RenderResult r) { result = std::move(r); });
    failed = !inbox_.run_until([&] { return result.has_value() || failed; }) || failed;
    if (result) {
      answer_.emplace(now_ + render_time, std::pair{job.number, std::move(*result)});
    }
  }

  TimePoint now_{};
  gemini::Device device_;
  PoseHistory poses_;
  Inbox inbox_;
  std::unique_ptr<RenderService> service_;
  std::optional<std::pair<TimePoint, std::pair<std::uint64_t, RenderResult>>> answer_;
};

// If the renderer's context is lost in the middle of pings, the daemon is notified once, and nothing is
// rendered or sent any more. (tests/unit/server/daemon/daemon_test.cpp tests the exit code of the process.)
TEST(LongRun, S18LostContextEndsTheServiceOnce) {
  int failures = 0;
  int rendered = 0;
  std::string reason;
  VirtualDaemon* that = nullptr;
  VirtualDaemon daemon(
      [&](const render::PingRequest& request) {
        if (request.ping_number == 5) {
          throw render::RendererError("the OpenGL context is lost");
        }
        ++rendered;
      },
      [&](const std::string& what) {
        ++failures;
        reason = what;
        that->failed = true;
      });
  that = &daemon;
  daemon.run_until(1h);
  EXPECT_TRUE(daemon.failed);
  EXPECT_LT(daemon.now(), 1min);
  EXPECT_EQ(failures, 1);
  EXPECT_EQ(reason, "the OpenGL context is lost");
  EXPECT_EQ(rendered, 5);
  bool answered = false;
  daemon.service().submit({}, [&](const RenderResult&) { answered = true; });
  daemon.service().stop();
  EXPECT_FALSE(answered);
}

/// Resident memory, bytes; 0 under sanitizers, which keep freed memory.
std::size_t resident_bytes() {
#ifdef SONARD_SANITIZED
  return 0;
#else
  std::ifstream statm("/proc/self/statm");
  std::size_t total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
#endif
}

// A renderer ten times too slow that also fails every seventh ping, for a day: each ping takes the newest
// pose, no ping queues up, and after the first hour memory grows by at most 12 bytes per ping.
TEST(LongRun, S20ADayOfARendererThatIsTooSlow) {
  VirtualDaemon daemon(
      [](const render::PingRequest& request) {
        if (request.ping_number % 7 == 3) {
          throw render::RequestError("dropped");
        }
      },
      [](const std::string& what) { ADD_FAILURE() << what; });
  daemon.run_until(1h);
  const std::size_t memory_before = resident_bytes();
  const std::uint64_t pings_before = daemon.pings + daemon.dropped;
  const std::uint64_t datagrams_before = daemon.datagrams;
  daemon.run_until(24h);
  ASSERT_FALSE(daemon.failed);
  const std::uint64_t pings = daemon.pings + daemon.dropped;
  EXPECT_GT(pings_before, 3000U);
  EXPECT_NEAR(static_cast<double>(pings), 24.0 * static_cast<double>(pings_before), 30.0);
  EXPECT_NEAR(static_cast<double>(daemon.datagrams), 24.0 * static_cast<double>(datagrams_before), 3000.0);
  EXPECT_GT(daemon.dropped, pings / 8);
  EXPECT_LE(daemon.oldest_pose_s, 0.1 + 1e-6) << "poses come every tenth of a second";
  EXPECT_LE(daemon.inbox().most(), 1U);
  EXPECT_LE(resident_bytes(), memory_before + (std::size_t{1} << 20));
}

}  // namespace
}  // namespace sonard::server
