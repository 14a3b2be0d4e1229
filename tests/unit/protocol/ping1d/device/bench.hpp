// SPDX-License-Identifier: Apache-2.0
// A Ping1D over a flat bed in virtual time. The bench records everything sent.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/ping1d/codec.hpp"
#include "protocol/ping1d/device.hpp"
#include "tests/support/device_bench.hpp"
#include "tests/unit/protocol/ping1d/device/bed.hpp"

namespace sonard::ping1d {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

inline const Peer client_a{0, {0x7F000001, 4000}, 0};
inline const Peer client_b{0, {0x7F000001, 4001}, 0};
inline const Peer serial_client{1, {}, 0};

inline DeviceConfig with_serial_line() {
  DeviceConfig config;
  config.serial_channel = 1;
  return config;
}

/// A frame from the head with its report, which views `frame`.
struct Heard {
  TimePoint at{};
  Peer to;
  Bytes frame;
  Report report;

  template <class Message>
  const Message* get() const {
    return std::get_if<Message>(&report);
  }
};

class Bench : public DeviceBench {
 public:
  explicit Bench(const DeviceConfig& config = {})
      : DeviceBench(device, [this](const PingJob& job) { return image_of(job, bed); }), device(config, 0ns) {
    render_time = 5ms;
    step(TimePassed{});
  }

  Device device;
  Bed bed{2.0};
  std::vector<Heard> heard;

  void raw(const Bytes& bytes, const Peer& from = client_a) { receive(from, bytes); }
  void command(const Command& command, const Peer& from = client_a) { raw(encode(command), from); }

  /// Sends a command and returns the answers that the head sends to this client at once.
  std::vector<Report> ask(const Command& question, const Peer& from = client_a) {
    const std::size_t before = heard.size();
    command(question, from);
    return answers(before, from);
  }
  std::vector<Report> answers(std::size_t before, const Peer& to) const {
    std::vector<Report> found;
    for (std::size_t i = before; i < heard.size(); ++i) {
      if (same_client(heard[i].to, to)) {
        found.push_back(heard[i].report);
      }
    }
    return found;
  }
  /// Requests a message and returns it; it must come within 50 ms.
  template <class Message>
  Message get(const Peer& from = client_a) {
    const std::size_t before = heard.size();
    const TimePoint end = now + 50ms;
    command(GeneralRequest{static_cast<std::uint16_t>(Message::id)}, from);
    while (true) {
      for (const Report& report : answers(before, from)) {
        if (const auto* const message = std::get_if<Message>(&report)) {
          return *message;
        }
      }
      if (next_event() > end) {
        ADD_FAILURE() << "no answer within 50 ms";
        return {};
      }
      run_once();
    }
  }
  template <class Message>
  std::vector<std::pair<TimePoint, Message>> all(std::size_t from = 0, const Peer& to = client_a) const {
    std::vector<std::pair<TimePoint, Message>> found;
    for (std::size_t i = from; i < heard.size(); ++i) {
      if (const auto* const message = heard[i].get<Message>(); message && same_client(heard[i].to, to)) {
        found.emplace_back(heard[i].at, *message);
      }
    }
    return found;
  }

 protected:
  void hear(const Outgoing& message) override {
    EXPECT_EQ(message.to, Outgoing::To::peer);
    Heard& it =
        heard.emplace_back(Heard{now, message.peer, {message.bytes.begin(), message.bytes.end()}, {}});
    ASSERT_EQ(next_frame(it.frame), static_cast<std::ptrdiff_t>(it.frame.size()))
        << "one whole frame at a time";
    const auto report = decode_report(it.frame);
    ASSERT_TRUE(report) << to_string(report.error());
    it.report = *report;
  }
};

inline bool is_ack(const std::vector<Report>& answers, std::uint16_t id) {
  return answers.size() == 1 && answers[0] == Report{Ack{id}};
}
inline std::string nack_text(const std::vector<Report>& answers, std::uint16_t id) {
  const auto* const nack = answers.size() == 1 ? std::get_if<Nack>(&answers[0]) : nullptr;
  return nack != nullptr && nack->nacked_id == id ? nack->text : "no nack";
}

}  // namespace sonard::ping1d
