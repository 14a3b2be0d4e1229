// SPDX-License-Identifier: Apache-2.0
// A serial link whose I/O runs on the test's thread, with a record of everything that it received.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <boost/asio/io_context.hpp>

#include "server/net/addresses.hpp"
#include "server/net/serial_link.hpp"
#include "server/net/udp_endpoint.hpp"
#include "tests/support/serial_client.hpp"

namespace sonard::server {

using test::Bytes;
using test::Client;

/// Frames from protocol/micron/README.md 10.
inline const Bytes send_version{0x40, 0x30, 0x30, 0x30, 0x38, 0x08, 0x00,
                                0xFF, 0x02, 0x03, 0x17, 0x80, 0x02, 0x0A};
inline const Bytes alive{0x40, 0x30, 0x30, 0x31, 0x30, 0x10, 0x00, 0x02, 0xFF, 0x0B, 0x04,
                         0x80, 0x02, 0x80, 0xAA, 0x10, 0x00, 0x00, 0x80, 0x0C, 0x5D, 0x0A};

/// `size` bytes that identify the frame and the position of each byte in it.
inline Bytes numbered_frame(int number, std::size_t size) {
  Bytes frame(size);
  for (std::size_t i = 0; i < size; ++i) {
    frame[i] = static_cast<std::uint8_t>(i < 2 ? number >> (8 * i) : static_cast<std::size_t>(number) + i);
  }
  return frame;
}

/// The numbers of the frames in a stream. A partial frame fails the test.
inline std::vector<int> frame_numbers(const Bytes& stream, std::size_t size) {
  std::vector<int> numbers;
  EXPECT_EQ(stream.size() % size, 0U) << "half a frame";
  for (std::size_t at = 0; at + size <= stream.size(); at += size) {
    const Bytes frame(stream.begin() + static_cast<std::ptrdiff_t>(at),
                      stream.begin() + static_cast<std::ptrdiff_t>(at + size));
    numbers.push_back(frame[0] | frame[1] << 8);
    EXPECT_EQ(frame, numbered_frame(numbers.back(), size)) << "at byte " << at;
  }
  return numbers;
}

/// A clock that the test sets.
class SteppedClock final : public Clock {
 public:
  TimePoint now() const override { return time; }
  /// At 1 ms every timer of the link is long overdue, so it reads this clock as soon as it is set.
  TimePoint time{std::chrono::milliseconds{1}};
};

class LinkTest : public testing::Test {
 protected:
  static constexpr Ipv4 localhost = 0x7F000001;
  static inline const AllowList loopback{{0x7F000000, 8}};
  static inline const SerialTcpConfig any_tcp{{localhost, 0}, loopback};
  static inline const SerialUdpConfig any_udp{{localhost, 0}, loopback};

  void open(const SerialLinkConfig& config, const Clock& clock) {
    link_ = std::make_unique<SerialLink>(io_, config, clock);
    link_->start(
        [this](std::span<const std::uint8_t> bytes, const std::string& peer) {
          heard_.insert(heard_.end(), bytes.begin(), bytes.end());
          peers_.push_back(peer);
        },
        [this](const std::string& peer) { left_.push_back(peer); });
  }
  void open(const SerialLinkConfig& config) { open(config, clock_); }

  /// Runs the I/O until the condition holds. @return false if it does not hold within ten seconds.
  bool run_until(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    while (!condition() && std::chrono::steady_clock::now() < deadline) {
      io_.run_one_for(std::chrono::milliseconds{1});
      io_.restart();
    }
    return condition();
  }
  /// Runs the I/O for a while, so that a forbidden event would occur.
  void run_for(std::chrono::milliseconds time) {
    const auto end = std::chrono::steady_clock::now() + time;
    while (std::chrono::steady_clock::now() < end) {
      io_.run_one_for(std::chrono::milliseconds{1});
      io_.restart();
    }
  }
  bool run_until_connections(std::uint64_t count) {
    return run_until([&] { return link_->counters().ports.connections == count; });
  }
  bool run_until_left(std::size_t count) {
    return run_until([&] { return left_.size() == count; });
  }
  bool run_until_heard(const Bytes& bytes) {
    return run_until([&] { return heard_ == bytes; });
  }
  bool run_until_hears(Client& client, const Bytes& bytes) {
    return run_until([&] { return client.heard() == bytes; });
  }

  Client tcp_client(Ipv4 from = localhost, int receive_buffer_bytes = 0) const {
    return Client::tcp(link_->addresses().tcp.at(0), from, receive_buffer_bytes);
  }
  Client udp_client(Ipv4 from = localhost) const { return Client::udp(link_->addresses().udp.at(0), from); }
  Client tty_client() const { return Client::tty(link_->addresses().pty.at(0)); }

  boost::asio::io_context io_;
  SteadyClock clock_;
  std::unique_ptr<SerialLink> link_;
  Bytes heard_;                     // received by the device, from all clients
  std::vector<std::string> peers_;  // one for each read
  std::vector<std::string> left_;
};

}  // namespace sonard::server
