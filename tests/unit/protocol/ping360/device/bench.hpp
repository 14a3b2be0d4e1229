// SPDX-License-Identifier: Apache-2.0
// A head in virtual time, with a renderer that takes a set time. The bench records everything sent.
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

#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/device.hpp"
#include "protocol/ping360/units.hpp"
#include "tests/support/device_bench.hpp"
#include "tests/support/messages.hpp"

namespace sonard::ping360 {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

/// A frame as the document prints it or clients send it (tests/data/ping360).
inline Bytes fixture(const std::string& name) {
  return sonard::testing::message_bytes("ping360", name);
}

// Clients. In tests with a serial line, it is channel 1.
inline const Peer client_a{0, {0x7F000001, 4000}, 0};
inline const Peer client_b{0, {0x7F000001, 4001}, 0};
inline const Peer serial_client{1, {}, 0};

inline DeviceConfig with_serial_line() {
  DeviceConfig config;
  config.serial_channel = 1;
  return config;
}

inline PingImage test_image(const PingJob& job) {
  return sonard::test_image(job, job.bins());
}
inline Bytes test_samples(std::uint64_t ping, int count) {
  PingJob job;
  job.number = ping;
  return sonard::test_image(job, count).u8;
}

/// A frame from the head with its report. It owns its data, because reports are views of `frame`.
struct Heard {
  TimePoint at{};
  Peer to;
  Bytes frame;
  Report report;  ///< a view of `frame`

  template <class Message>
  const Message* get() const {
    return std::get_if<Message>(&report);
  }
};

class Bench : public DeviceBench {
 public:
  explicit Bench(const DeviceConfig& config = {})
      : DeviceBench(device, test_image), device(config, 0ns), max_datagram_(config.max_datagram) {
    step(TimePassed{});
  }

  // Read by tests.
  Device device;
  std::vector<Heard> heard;
  std::vector<Outgoing> datagrams;

  void raw(const Bytes& bytes, const Peer& from = client_a) { receive(from, bytes); }
  void command(const Command& command, const Peer& from = client_a) { raw(encode(command), from); }

  /// The reports of one type among those sent from index `from` on.
  template <class Message>
  std::vector<Message> all(std::size_t from = 0) const {
    std::vector<Message> found;
    for (std::size_t i = from; i < heard.size(); ++i) {
      if (const auto* const message = heard[i].get<Message>()) {
        found.push_back(*message);
      }
    }
    return found;
  }
  /// Sends a command and returns the answers that the head sends at once.
  std::vector<Report> ask(const Command& question, const Peer& from = client_a) {
    const std::size_t before = heard.size();
    command(question, from);
    std::vector<Report> answers;
    for (std::size_t i = before; i < heard.size(); ++i) {
      answers.push_back(heard[i].report);
    }
    return answers;
  }

  /// Runs until `count` more messages of this type were sent, for at most `limit`.
  template <class Message>
  std::vector<Message> wait_for(std::size_t count, std::chrono::nanoseconds limit = 100s) {
    const std::size_t from = heard.size();
    for (const TimePoint end = now + limit; all<Message>(from).size() < count && next_event() <= end;) {
      run_once();
    }
    const auto found = all<Message>(from);
    EXPECT_EQ(found.size(), count);
    return found;
  }

  /// The texts of all notices.
  std::vector<std::string> told() const {
    std::vector<std::string> texts;
    std::ranges::transform(notices, std::back_inserter(texts), &Notice::text);
    return texts;
  }

 protected:
  /// Each message must be one frame, unless the head is configured to split frames.
  void hear(const Outgoing& message) override {
    EXPECT_EQ(message.to, Outgoing::To::peer);
    datagrams.push_back(message);
    partial_.insert(partial_.end(), message.bytes.begin(), message.bytes.end());
    const auto found = next_frame(partial_);
    if (max_datagram_ > 0 && found == 0) {
      EXPECT_EQ(message.bytes.size(), max_datagram_);
      return;
    }
    ASSERT_EQ(found, static_cast<std::ptrdiff_t>(partial_.size())) << "one whole frame at a time";
    Heard& it = heard.emplace_back(Heard{now, message.peer, std::exchange(partial_, {}), {}});
    const auto report = decode_report(it.frame);
    ASSERT_TRUE(report) << to_string(report.error());
    it.report = *report;
  }

 private:
  std::size_t max_datagram_;
  Bytes partial_;
};

/// The value of a job's setting as a log shows it; empty if the job lacks it.
inline std::string setting(const PingJob& job, std::string_view name) {
  const auto found = std::ranges::find(job.settings, name, &Setting::name);
  return found == job.settings.end() ? std::string() : found->value;
}

inline Bytes bytes_of(std::span<const std::uint8_t> data) {
  return {data.begin(), data.end()};
}

inline std::vector<int> angles_of(const std::vector<AutoDeviceData>& pings) {
  std::vector<int> angles;
  std::ranges::transform(pings, std::back_inserter(angles), &AutoDeviceData::angle);
  return angles;
}

/// A short ping: 200 samples of 2 us.
inline Transducer ping_at(int angle) {
  Transducer command;
  command.angle = static_cast<std::uint16_t>(angle);
  command.number_of_samples = 200;
  return command;
}

inline AutoTransmit scan_of(int start, int stop, int step = 1) {
  AutoTransmit command;
  command.number_of_samples = 200;
  command.start_angle = static_cast<std::uint16_t>(start);
  command.stop_angle = static_cast<std::uint16_t>(stop);
  command.num_steps = static_cast<std::uint8_t>(step);
  return command;
}

}  // namespace sonard::ping360
