// SPDX-License-Identifier: Apache-2.0
// The viewer of a head of the Ping protocol, whatever its device.
#pragma once

#include <fmt/format.h>

#include <boost/crc.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "clients/sonarview/common/line_viewer.hpp"
#include "common/text/printable.hpp"

namespace sonard::client {

/// CRC-32 of the samples of a ping, as `--log-pings` prints it.
inline std::uint32_t crc32_of(std::span<const std::uint8_t> samples) {
  boost::crc_32_type crc;
  crc.process_bytes(samples.data(), samples.size());
  return crc.checksum();
}

/// @tparam Client the client's side of the protocol, constructed with the present time
template <class Client, class Ping>
class PingViewer : public LineViewer {
 public:
  /// `head` is the device with its article.
  PingViewer(const RunOptions& run, const LineAddress& line, std::string head)
      : LineViewer(run), client_(started()), line_(line), head_(std::move(head)) {}

 protected:
  virtual void take_ping(const Ping& ping) = 0;
  /// The identity of the head, which is printed once; nullopt: not known yet.
  virtual std::optional<std::string> identity() const = 0;

  std::string line_text() const { return line_.text(); }

  Client client_;

 private:
  void on_bytes(TimePoint at, std::span<const std::uint8_t> bytes) override { client_.on_bytes(at, bytes); }
  void talk(TimePoint at) override {
    client_.advance(at);
    for (const std::vector<std::uint8_t>& frame : client_.take_outgoing()) {
      send(frame);
    }
  }
  std::optional<TimePoint> next_deadline() const override { return client_.next_deadline(); }
  bool head_met() const override { return client_.statistics().frames > 0; }
  bool finished() const override { return client_.finished(); }

  void take_received() override {
    if (const auto text = greeted_ ? std::nullopt : identity()) {
      greeted_ = true;
      say(*text);
    }
    for (const Ping& ping : client_.take_pings()) {
      if (!stopping()) {
        take_ping(ping);
      }
    }
    if (const auto& refusal = client_.refusal(); refusal && !stopping()) {
      give_up(ExitStatus::incomplete, "the head refused a command: " + printable(refusal->text));
    }
  }

  /// Stops the head, because it continues without its client.
  std::chrono::nanoseconds say_goodbye(TimePoint at) override {
    client_.stop(at);
    return std::chrono::milliseconds{head_met() ? 500 : 0};
  }

  std::string awaited_text() const override { return fmt::format("a head on {}", line_text()); }
  std::string no_head_text(double wait_s) const override {
    const std::uint64_t foreign = client_.statistics().dropped_bytes;
    return fmt::format("{} is open, but no head answered within {:.1f} s{}", line_text(), wait_s,
                       foreign > 0 ? ": " + foreign_bytes_text(foreign, head_) : "");
  }
  std::string no_ping_text(double wait_s) const override {
    return fmt::format("no ping for {:.1f} s", wait_s);
  }

  LineAddress line_;
  std::string head_;
  bool greeted_ = false;
};

}  // namespace sonard::client
