// SPDX-License-Identifier: Apache-2.0
// A head in virtual time, with a renderer that takes a set time. The bench records every frame sent.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/device.hpp"
#include "protocol/micron/units.hpp"
#include "tests/support/device_bench.hpp"
#include "tests/support/messages.hpp"

namespace sonard::micron {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

/// A frame as drivers send it or heads answer it (tests/data/micron).
inline Bytes fixture(const std::string& name) {
  return sonard::testing::message_bytes("micron", name);
}

inline PingImage test_line(const PingJob& job) {
  return test_image(job, job.bins());
}

/// A sector from `left` to `right`, clockwise first, with 20 bins for quick lines.
inline HeadCommand sector(std::uint16_t left, std::uint16_t right, std::uint8_t step = 32) {
  HeadCommand command;
  command.control = 0x2305;
  command.left_limit = left;
  command.right_limit = right;
  command.step = step;
  command.bins = 20;
  return command;
}

/// A full turn to the right, or to the left, with 20 bins.
inline HeadCommand all_round(std::uint8_t step = 32, bool right = true) {
  HeadCommand command = sector(0, 0, step);
  command.control = right ? 0x2307 : 0x2303;
  return command;
}

class Bench : public DeviceBench {
 public:
  struct Sent {
    TimePoint at{};
    Bytes bytes;
  };

  explicit Bench(const DeviceConfig& config = {})
      : DeviceBench(device, test_line), device(config, 0ns), node_(config.node) {
    step(TimePassed{});
  }

  /// Set by tests. Called for each frame as it is sent. It must not call the bench.
  std::function<void(const Sent&)> on_sent;

  // Read by tests.
  Device device;
  std::vector<Sent> sent;

  void raw(std::span<const std::uint8_t> bytes) { receive({}, Bytes(bytes.begin(), bytes.end())); }
  void command(const Command& command) { raw(encode(command, node_)); }
  /// Turns the head to a bearing, reboots it and clears `sent`. Returns the time of the reboot.
  TimePoint reboot_at(std::uint16_t bearing) {
    command(sector(bearing, bearing));
    run_for(3s);
    command(Reboot{});
    sent.clear();
    return now;
  }
  void power_cycle() {
    device.power_cycle(now);
    step(TimePassed{});
  }

  /// Centres the head, sends these parameters and clears `sent`. The head can then ping.
  void make_ready(const HeadCommand& parameters) {
    run_until(10s);
    command(parameters);
    run_for(2s);
    sent.clear();
  }
  /// Requests another line after each line, as most drivers do, until there are `count` lines.
  std::vector<HeadData> scan(std::size_t count) {
    const std::size_t from = sent.size();
    std::size_t seen = 0;
    command(SendData{});
    for (const TimePoint end = now + 100s; seen < count && now < end;) {
      run_once();
      for (const std::size_t lines = all<HeadData>(from).size(); seen < std::min(lines, count); ++seen) {
        command(SendData{});
      }
    }
    std::vector<HeadData> lines;
    for (const auto& [at, line] : all<HeadData>(from)) {
      lines.push_back(line);
    }
    EXPECT_GE(lines.size(), count);
    lines.resize(std::min(lines.size(), count));
    return lines;
  }

  /// The messages of one type among those sent from index `from` on. Lines are views of `sent`.
  template <class Message>
  std::vector<std::pair<TimePoint, Message>> all(std::size_t from = 0) const {
    std::vector<std::pair<TimePoint, Message>> found;
    for (std::size_t i = from; i < sent.size(); ++i) {
      const auto report = decode_report(sent[i].bytes);
      if (!report) {
        ADD_FAILURE() << "undecodable frame sent: " << to_string(report.error());
        continue;
      }
      if (const Message* message = std::get_if<Message>(&*report)) {
        found.emplace_back(sent[i].at, *message);
      }
    }
    return found;
  }
  /// HeadInf of every alive sent from index `from` on.
  std::vector<int> head_infos(std::size_t from = 0) const {
    std::vector<int> infos;
    for (const auto& [at, alive] : all<Alive>(from)) {
      infos.push_back(alive.head_info);
    }
    return infos;
  }

 protected:
  void hear(const Outgoing& frame) override {
    sent.push_back({now, Bytes(frame.bytes.begin(), frame.bytes.end())});
    EXPECT_EQ(next_frame(sent.back().bytes, max_report_frame_size),
              static_cast<std::ptrdiff_t>(sent.back().bytes.size()))
        << "one whole frame at a time";
    if (on_sent) {
      on_sent(sent.back());
    }
  }

 private:
  std::uint8_t node_;
};

/// The value of a job's setting as a log shows it; empty if the job lacks it.
inline std::string setting(const PingJob& job, std::string_view name) {
  const auto found = std::ranges::find(job.settings, name, &Setting::name);
  return found == job.settings.end() ? std::string() : found->value;
}

inline std::vector<int> bearings_of(const std::vector<HeadData>& lines) {
  std::vector<int> bearings;
  for (const HeadData& line : lines) {
    bearings.push_back(line.bearing);
  }
  return bearings;
}

}  // namespace sonard::micron
