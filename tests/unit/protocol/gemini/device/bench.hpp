// SPDX-License-Identifier: Apache-2.0
// A head in virtual time, with a renderer that takes a set time. The bench records everything sent.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "protocol/gemini/messages.hpp"
#include "tests/support/device_bench.hpp"

namespace sonard::gemini {

using namespace std::chrono_literals;

inline constexpr Ipv4 head_address = 0xC0A802C9;    // 192.168.2.201
inline constexpr Ipv4 client_address = 0xC0A80205;  // 192.168.2.5
inline constexpr Ipv4 other_client = 0xC0A80206;    // 192.168.2.6

/// The bytes of hexadecimal text such as "20 01 59". All other characters are skipped.
inline std::vector<std::uint8_t> from_hex(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  int digits = 0;
  for (const char c : text) {
    const bool number = c >= '0' && c <= '9';
    const bool letter = c >= 'a' && c <= 'f';
    if (!number && !letter) {
      continue;
    }
    const int nibble = number ? c - '0' : c - 'a' + 10;
    if (digits++ % 2 == 0) {
      bytes.push_back(static_cast<std::uint8_t>(nibble << 4));
    } else {
      bytes.back() = static_cast<std::uint8_t>(bytes.back() | nibble);
    }
  }
  return bytes;
}

inline std::vector<std::uint8_t> copy(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

/// The head of the worked examples (protocol/gemini/README.md 10): ID 601, 192.168.2.201/24, MAC
/// 00:12:34:00:02:59.
inline DeviceConfig example_config() {
  DeviceConfig config;
  config.sonar_id = 601;
  config.alternate_address = head_address;
  config.netmask = 0xFFFFFF00;
  config.mac = {0x00, 0x12, 0x34, 0x00, 0x02, 0x59};
  return config;
}

/// A message addressed to the head of the examples.
template <class Message>
Message to_head(Message message = {}) {
  message.header.sonar_id = 601;
  return message;
}

/// 8 bit, uncompressed, pings out of water too.
inline PingConfig ping_of(int lines, RunMode mode = RunMode::single,
                          std::chrono::microseconds interval = 200ms) {
  auto config = to_head<PingConfig>();
  config.run_mode = static_cast<std::uint16_t>(mode);
  config.ext_mode = 0x0204;
  config.end_range = static_cast<std::uint16_t>(lines);
  config.interping_us = static_cast<std::uint32_t>(interval.count());
  return config;
}

inline RetryRequest retry_of(RetryKind kind, int first = 0, int count = 1) {
  auto request = to_head<RetryRequest>();
  request.kind = kind;
  request.first_line = static_cast<std::uint16_t>(first);
  request.line_count = static_cast<std::uint16_t>(count);
  return request;
}

inline PingImage test_image(const PingJob& job) {
  return sonard::test_image(job, job.bins(), beam_count);
}

class Bench : public DeviceBench {
 public:
  struct Sent {
    TimePoint at{};
    Outgoing::To to = Outgoing::To::peer;
    Ipv4 client = 0;
    Ipv4 reply_from = 0;
    SharedBytes bytes;

    std::uint8_t type() const { return bytes[0]; }
  };

  explicit Bench(const DeviceConfig& config = example_config())
      : DeviceBench(device, test_image), device(config, 0ns) {
    step(TimePassed{});
  }

  /// Set by tests. Called for each datagram as it is sent. It must not call the bench.
  std::function<void(const Sent&)> on_sent;

  // Read by tests.
  Device device;
  std::vector<Sent> sent;

  void raw(std::span<const std::uint8_t> bytes, Ipv4 from = client_address, Ipv4 to = head_address) {
    receive({0, {from, client_port}, to}, copy(bytes));
  }
  void command(const Command& command, Ipv4 from = client_address) { raw(encode(command), from); }
  void trigger() { step(TriggerEdge{}); }
  void set_out_of_water(bool out) { step(WaterChanged{out}); }

  /// Like run_for, with a stay-alive every second.
  void run_connected(std::chrono::nanoseconds span) {
    for (const TimePoint end = now + span; now < end;) {
      command(to_head<StatusRequest>());
      run_until(std::min(end, now + 1s));
    }
  }

  /// The messages of one type among those sent from index `from` on.
  template <class Message>
  std::vector<std::pair<TimePoint, Message>> all(std::size_t from = 0) const {
    std::vector<std::pair<TimePoint, Message>> found;
    for (std::size_t i = from; i < sent.size(); ++i) {
      const auto report = decode_report(sent[i].bytes);
      if (!report) {
        ADD_FAILURE() << "undecodable datagram sent: " << to_string(report.error());
        continue;
      }
      if (const Message* message = std::get_if<Message>(&*report)) {
        found.emplace_back(sent[i].at, *message);
      }
    }
    return found;
  }
  /// Datagrams of pings (types 0x41, 0x42, 0x43), from index `from` on.
  std::vector<Sent> ping_datagrams(std::size_t from = 0) const {
    std::vector<Sent> found;
    for (std::size_t i = from; i < sent.size(); ++i) {
      if (sent[i].type() >= 0x41 && sent[i].type() <= 0x43) {
        found.push_back(sent[i]);
      }
    }
    return found;
  }
  std::size_t count(MessageType type) const {
    std::size_t n = 0;
    for (const Sent& datagram : sent) {
      n += datagram.type() == static_cast<std::uint8_t>(type) ? 1U : 0U;
    }
    return n;
  }

 protected:
  void hear(const Outgoing& outgoing) override {
    sent.push_back({now, outgoing.to, outgoing.peer.remote.address, outgoing.peer.local, outgoing.bytes});
    if (on_sent) {
      on_sent(sent.back());
    }
  }
};

}  // namespace sonard::gemini
