// SPDX-License-Identifier: Apache-2.0
// A Micron client as a pure state machine: input is bytes and time, output is frames and lines. It uses no
// serial ports, sockets, clocks or threads. Source: protocol/micron/README.md 5, 7, 8.
//
// It follows most drivers: waits for an alive, requests the version and user blocks, sends parameters, waits
// until the head reports that it is centred and has them, then requests lines. It repeats lost requests. It
// sends the parameters again if the head has rebooted or lost its step.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "protocol/micron/bins.hpp"
#include "protocol/micron/frame.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

struct ClientConfig {
  std::uint8_t node = default_head_node;  ///< of the head
  NibbleOrder nibble_order = NibbleOrder::high_first;
  bool reboot_first = false;  ///< reboot the head first, so that it has no parameters
};

/// Data that the head has sent about itself.
struct HeadIdentity {
  std::optional<VersionData> version;
  std::optional<BBUserData> user_blocks;  ///< nullopt: not received
  std::optional<Alive> alive;             ///< the newest
};

/// One line of a scan.
struct ReceivedLine {
  std::uint64_t number = 0;  ///< 0, 1, 2, ... in the order of delivery
  TimePoint received{};
  HeadData head;                   ///< without its data
  std::vector<std::uint8_t> bins;  ///< from near to far: 0..255, or 0..15 in 4-bit lines
};

/// Counters since construction. They only grow.
struct ClientStatistics {
  std::uint64_t frames = 0;         ///< whole, and for this client
  std::uint64_t dropped_bytes = 0;  ///< not part of a frame
  std::uint64_t bad_frames = 0;     ///< undecodable
  std::uint64_t other_nodes = 0;    ///< not from the head, or not for this client
  std::uint64_t alives = 0;
  std::uint64_t lines = 0;              ///< delivered
  std::uint64_t lines_unmatched = 0;    ///< made with other parameters than this client's
  std::uint64_t lines_unrequested = 0;  ///< arrived while no line was requested
  std::uint64_t requests = 0;
  std::uint64_t timeouts = 0;       ///< requests without a line in answer
  std::uint64_t head_commands = 0;  ///< parameters sent, including repetitions
  std::uint64_t reboots = 0;        ///< the head had lost its parameters
  std::uint64_t motor_errors = 0;   ///< lines that reported a lost step
};

/// Not thread-safe: one thread calls everything. `now` never goes backwards.
class Client {
 public:
  Client(const ClientConfig& config, TimePoint now);

  /// Handles bytes from the head, in parts of any size. Counts and drops bad ones.
  void on_bytes(TimePoint now, std::span<const std::uint8_t> bytes);

  /// Scans with these parameters (1..1500 bins, ad_interval >= 1), at once or when the head is known;
  /// replaces the running scan. Ends after `lines` delivered lines; 0: continues until stop().
  void start(TimePoint now, const HeadCommand& parameters, std::uint64_t lines);
  /// Changes gain and window of the scan; has no effect before start().
  void set_gain(const GainBlock& values);
  /// Reverses the scan; has no effect before start().
  void reverse();
  /// Stops requesting lines. Lines that the head still owes are not delivered.
  void stop();

  /// Runs everything that is due at `now`. Call after every other call and at next_deadline().
  void advance(TimePoint now);
  /// When to call advance() next; nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const;

  /// Frames due, in order; write each at once. Each call empties the list.
  std::vector<std::vector<std::uint8_t>> take_outgoing();
  /// Received lines, in order. Each call empties the list.
  std::vector<ReceivedLine> take_lines();

  const HeadIdentity& head() const { return head_; }
  /// Nodes other than the head that sent frames to this client.
  const std::set<std::uint8_t>& other_heads() const { return other_heads_; }
  /// True if all lines of start() are delivered, or stop() was called.
  bool finished() const { return stopped_ || (programme_ && programme_->finished()); }
  const ClientStatistics& statistics() const { return statistics_; }

 private:
  enum class Phase : std::uint8_t { meeting, idle, configuring, scanning };

  /// The arguments of start(), and its progress.
  struct Programme {
    HeadCommand parameters;
    std::uint64_t wanted = 0;
    std::uint64_t delivered = 0;

    bool finished() const { return wanted > 0 && delivered >= wanted; }
  };

  void take_frame(TimePoint now, std::span<const std::uint8_t> frame);
  void on_report(TimePoint now, const Alive& alive);
  void on_report(TimePoint now, const VersionData& version);
  void on_report(TimePoint now, const BBUserData& blocks);
  void on_report(TimePoint now, const HeadData& line);
  template <class Other>
  void on_report(TimePoint, const Other&) {}  // a client does not need these

  void ask_identity(TimePoint now);
  void met(TimePoint now);
  void configure(TimePoint now);
  void request(TimePoint now);
  void on_timeout(TimePoint now);
  bool matches(const HeadData& line) const;
  int lines_per_request() const;
  std::chrono::nanoseconds line_timeout() const;
  template <class Message>
  void send(const Message& message);

  ClientConfig config_;
  FrameBuffer input_;
  HeadIdentity head_;
  std::set<std::uint8_t> other_heads_;
  Phase phase_ = Phase::meeting;
  std::optional<TimePoint> due_;  ///< time-out of the phase
  int tries_ = 0;       ///< user blocks: requests without an answer; configuring: alives without effect;
                        ///< scanning: requests without a line
  bool asked_ = false;  ///< meeting: a request was sent to the head
  std::optional<Programme> programme_;
  bool stopped_ = false;
  int expected_ = 0;  ///< requested lines that have not arrived
  std::vector<std::vector<std::uint8_t>> outgoing_;
  std::vector<ReceivedLine> lines_;
  ClientStatistics statistics_;
};

}  // namespace sonard::micron
