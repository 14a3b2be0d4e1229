// SPDX-License-Identifier: Apache-2.0
// The host's side of a Micron as a pure state machine: bytes and time go in; frames and lines come out. It
// knows no serial ports, sockets, clocks or threads. Source: docs/protocols/micron.md 5, 7, 8.
//
// It goes the way that most drivers go: waits for the head to speak, asks who it is and how its link works,
// gives it parameters, waits until it says that it is centred and has them, then asks for lines. Whatever is
// lost on the way is asked for again; a head that has rebooted or lost its step gets its parameters again.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/micron/bins.hpp"
#include "protocol/micron/frame.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

struct HostConfig {
  std::uint8_t node = default_head_node;  ///< of the head
  NibbleOrder nibble_order = NibbleOrder::high_first;
  bool reboot_first = false;  ///< begin with a head that has forgotten everything
};

/// What a head has said of itself.
struct HeadIdentity {
  std::optional<VersionData> version;
  std::optional<BBUserData> user_blocks;  ///< nullopt: the request was not answered
  std::optional<Alive> alive;             ///< the newest
};

/// One line of a scan.
struct ReceivedLine {
  std::uint64_t number = 0;  ///< 0, 1, 2, ... in the order of delivery
  TimePoint received{};
  HeadData head;                   ///< all but its data
  std::vector<std::uint8_t> bins;  ///< from near to far: 0..255, or 0..15 of 4-bit lines
};

/// Counters since construction. They only grow.
struct HostStatistics {
  std::uint64_t frames = 0;         ///< whole, and for this host
  std::uint64_t dropped_bytes = 0;  ///< part of no frame
  std::uint64_t bad_frames = 0;     ///< could not be read
  std::uint64_t other_nodes = 0;    ///< not from the head, or not for us
  std::uint64_t alives = 0;
  std::uint64_t lines = 0;              ///< delivered
  std::uint64_t lines_unmatched = 0;    ///< of other parameters than those of this host
  std::uint64_t lines_unrequested = 0;  ///< came while nothing was asked for
  std::uint64_t requests = 0;
  std::uint64_t timeouts = 0;       ///< requests that no line came for
  std::uint64_t head_commands = 0;  ///< parameters sent, the first time and again
  std::uint64_t reboots = 0;        ///< the head had lost its parameters
  std::uint64_t motor_errors = 0;   ///< lines that told a lost step
};

/// Not thread-safe: one thread calls everything. `now` never goes backwards.
class Host {
 public:
  Host(const HostConfig& config, TimePoint now);

  /// Bytes from the head, cut as they happen to come. Bad ones are counted and dropped.
  void on_bytes(TimePoint now, std::span<const std::uint8_t> bytes);

  /// Scans with these parameters (1..1500 bins, ad_interval >= 1), at once or as soon as the head is known;
  /// replaces what was running. Ends after `lines` delivered lines; 0: continues until stop().
  void start(TimePoint now, const HeadCommand& parameters, std::uint64_t lines);
  /// Changes gain and window of a running scan; does nothing before start().
  void set_gain(const GainBlock& values);
  /// Turns the scan about; nothing before start().
  void reverse();
  /// Asks for nothing more. What the head still owes is not delivered.
  void stop();

  /// Runs everything due at `now`. Call after every other call and at next_deadline().
  void advance(TimePoint now);
  /// When advance() is next needed; nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const;

  /// Frames due, in order, each to be written in one go. Each call empties the list.
  std::vector<std::vector<std::uint8_t>> take_outgoing();
  /// Lines that came, in order. Each call empties the list.
  std::vector<ReceivedLine> take_lines();

  const HeadIdentity& head() const { return head_; }
  /// All lines asked for by start() are delivered, or stop() was called.
  bool finished() const { return stopped_ || (programme_ && programme_->finished()); }
  const HostStatistics& statistics() const { return statistics_; }

 private:
  enum class Phase : std::uint8_t { meeting, idle, configuring, scanning };

  /// What start() asked for.
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
  void on_report(TimePoint, const Other&) {}  // nothing that a host needs

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

  HostConfig config_;
  FrameBuffer input_;
  HeadIdentity head_;
  Phase phase_ = Phase::meeting;
  std::optional<TimePoint> due_;  ///< when what the phase waits for is given up
  int tries_ = 0;       ///< user blocks: requests without an answer; configuring: alives without effect;
                        ///< scanning: requests without a line
  bool asked_ = false;  ///< meeting: the head was asked something
  std::optional<Programme> programme_;
  bool stopped_ = false;
  int expected_ = 0;  ///< lines asked for
  std::vector<std::vector<std::uint8_t>> outgoing_;
  std::vector<ReceivedLine> lines_;
  HostStatistics statistics_;
};

}  // namespace sonard::micron
