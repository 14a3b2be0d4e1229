// SPDX-License-Identifier: Apache-2.0
// A Micron on a real serial line; the test supplies its echoes.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "protocol/micron/device.hpp"
#include "server/net/serial_link.hpp"

namespace sonard::test {

/// The head of protocol/micron on one end of a SerialLink, on its own thread. It has been powered for long,
/// so it is centred. It pings as fast as clients request.
class FakeHead {
 public:
  using Bytes = std::vector<std::uint8_t>;

  struct Settings {
    micron::DeviceConfig device = quick();
    /// One sample, 0..255. Called on the head's thread.
    std::function<std::uint8_t(int bearing, int bin)> echo;
    /// Splits a frame of the head on the line; the parts arrive a millisecond apart.
    std::function<std::vector<Bytes>(const Bytes& frame)> carry = [](const Bytes& frame) {
      return std::vector<Bytes>{frame};
    };
    /// Before this ping the line vanishes; it comes back after `away`.
    std::optional<std::uint64_t> vanish_at_ping = std::nullopt;
    std::chrono::milliseconds away{1500};
  };

  FakeHead(server::SerialLinkConfig link, Settings settings);
  ~FakeHead();
  FakeHead(const FakeHead&) = delete;
  FakeHead& operator=(const FakeHead&) = delete;

  const std::string& tcp() const { return tcp_; }  ///< HOST:PORT
  const std::string& udp() const { return udp_; }
  const std::string& tty() const { return tty_; }
  std::uint64_t pings() const { return pings_; }

 private:
  static micron::DeviceConfig quick();
  void open();
  void vanish();
  void step(const Event& event);
  PingImage echoes(const PingJob& job) const;
  void send_all(const Actions& actions);
  void send(const Bytes& frame);
  void send_piece();
  void arm_timer(const std::optional<TimePoint>& wake_at);

  server::SerialLinkConfig link_config_;
  Settings settings_;
  server::SteadyClock clock_;
  boost::asio::io_context io_;
  boost::asio::steady_timer timer_{io_};
  boost::asio::steady_timer piece_timer_{io_};
  boost::asio::steady_timer away_timer_{io_};
  std::unique_ptr<server::SerialLink> link_;
  micron::Device device_;
  std::deque<Bytes> pieces_;
  std::string tcp_;
  std::string udp_;
  std::string tty_;
  std::atomic<std::uint64_t> pings_ = 0;
  std::thread thread_;
};

}  // namespace sonard::test
