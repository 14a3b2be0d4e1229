// SPDX-License-Identifier: Apache-2.0
// A Ping1D client as a pure state machine: input is bytes and time, output is frames and pings. It uses no
// serial ports, sockets, clocks or threads. Source: protocol/ping1d/README.md 3, 5.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "protocol/common/ping_job.hpp"
#include "protocol/ping1d/messages.hpp"

namespace sonard::ping1d {

struct ReceivedPing {
  TimePoint received{};
  Distance measured;
  std::vector<std::uint8_t> profile;  ///< nearest point first
};

/// Counters since construction. They only grow.
struct ClientStatistics {
  std::uint64_t frames = 0;         ///< decoded
  std::uint64_t dropped_bytes = 0;  ///< not part of a frame
  std::uint64_t bad_frames = 0;     ///< undecodable
  std::uint64_t pings = 0;
  std::uint64_t pings_missed = 0;  ///< gaps in the numbers of received pings
  std::uint64_t timeouts = 0;      ///< the stream was requested again, because no ping came
};

/// Not thread-safe: one thread calls everything. `now` never goes backwards.
class Client {
 public:
  explicit Client(TimePoint now) : due_(now) {}

  /// Handles bytes from the head, in parts of any size. Counts and drops bad ones.
  void on_bytes(TimePoint now, std::span<const std::uint8_t> bytes);

  /// Sends the settings and requests a stream of profiles, at once or when the head is known. Ends after
  /// `pings` pings; 0: continues until stop().
  void start(TimePoint now, std::vector<Command> settings, std::uint64_t pings);
  /// Ends the stream, and repeats the command until the head acknowledges it.
  void stop(TimePoint now);

  /// Runs everything that is due at `now`. Call after every other call and at next_deadline().
  void advance(TimePoint now);
  /// When to call advance() next; nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const { return due_; }

  /// Frames due, in order, each as its own datagram. Each call empties the list.
  std::vector<std::vector<std::uint8_t>> take_outgoing() { return std::exchange(outgoing_, {}); }
  /// Received pings, in order. Each call empties the list.
  std::vector<ReceivedPing> take_pings() { return std::exchange(pings_, {}); }

  const std::optional<DeviceInformation>& information() const { return information_; }
  /// The head's refusal of a command.
  const std::optional<Nack>& refusal() const { return refusal_; }
  /// True if all pings of start() have arrived. After stop(): true if the head has stopped or does not
  /// answer.
  bool finished() const { return finished_; }
  const ClientStatistics& statistics() const { return statistics_; }

 private:
  enum class Phase : std::uint8_t { meeting, idle, listening, stopping };

  void on_report(TimePoint now, const DeviceInformation& information);
  void on_report(TimePoint now, const Profile& profile);
  void on_report(TimePoint now, const Ack& ack);
  void on_report(TimePoint, const Nack& nack) { refusal_ = nack; }
  template <class Other>
  void on_report(TimePoint, const Other&) {}  // a client does not need these

  void request_stream(TimePoint now);
  void send(const Command& command);

  FrameBuffer input_;
  Phase phase_ = Phase::meeting;
  std::optional<TimePoint> due_;  ///< time-out of the phase
  int stop_orders_ = 0;
  std::optional<std::vector<Command>> settings_;
  std::uint64_t wanted_ = 0;
  std::optional<std::uint32_t> last_number_;
  std::optional<DeviceInformation> information_;
  std::optional<Nack> refusal_;
  bool finished_ = false;
  std::vector<std::vector<std::uint8_t>> outgoing_;
  std::vector<ReceivedPing> pings_;
  ClientStatistics statistics_;
};

}  // namespace sonard::ping1d
