// SPDX-License-Identifier: Apache-2.0
// A Ping360 client as a pure state machine: input is bytes and time, output is frames and pings. It uses no
// serial ports, sockets, clocks or threads. Source: protocol/ping360/README.md 3, 6.
//
// It follows known clients: requests protocol version, identity and state, then either commands one ping
// after another and waits for each, or starts a scan and listens. It repeats unanswered requests.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "protocol/ping360/messages.hpp"
#include "protocol/ping360/ping_form.hpp"

namespace sonard::ping360 {

/// Data that the head has sent about itself.
struct HeadIdentity {
  std::optional<ProtocolVersion> protocol;
  std::optional<DeviceInformation> information;
  std::optional<PingForm> state;  ///< at first contact
};

struct ReceivedPing {
  std::uint64_t number = 0;  ///< 0, 1, 2, ... in the order of delivery
  TimePoint received{};
  PingForm form;
  std::vector<std::uint8_t> samples;  ///< from near to far
};

/// Counters since construction. They only grow.
struct ClientStatistics {
  std::uint64_t frames = 0;         ///< decoded
  std::uint64_t dropped_bytes = 0;  ///< not part of a frame
  std::uint64_t bad_frames = 0;     ///< undecodable
  std::uint64_t pings = 0;          ///< delivered
  /// Pings of another scan, second copies, and unrequested pings, except while stopping.
  std::uint64_t pings_unwanted = 0;
  std::uint64_t commands = 0;  ///< commands for pings, including repetitions
  std::uint64_t timeouts = 0;  ///< commands without a ping in answer
};

/// Not thread-safe: one thread calls everything. `now` never goes backwards.
class Client {
 public:
  explicit Client(TimePoint now);

  /// Handles bytes from the head, in parts of any size. Counts and drops bad ones.
  void on_bytes(TimePoint now, std::span<const std::uint8_t> bytes);

  /// Commands single pings, each `step` gradians after the last, at once or when the head is known; replaces
  /// the running programme. Ends after `pings` delivered pings; 0: continues until stop().
  void start(TimePoint now, const Transducer& first, int step, std::uint64_t pings);
  /// Starts a scan, at once or when the head is known. `pings` as in the other overload.
  void start(TimePoint now, const AutoTransmit& scan, std::uint64_t pings);
  /// Stops requesting pings, and repeats the stop command until the head acknowledges it.
  void stop(TimePoint now);

  /// Runs everything that is due at `now`. Call after every other call and at next_deadline().
  void advance(TimePoint now);
  /// When to call advance() next; nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const;

  /// Frames due, in order, each as its own datagram. Send empty ones over UDP too, but skip them on other
  /// lines. Each call empties the list.
  std::vector<std::vector<std::uint8_t>> take_outgoing();
  /// Received pings, in order. Each call empties the list.
  std::vector<ReceivedPing> take_pings();

  const HeadIdentity& head() const { return head_; }
  /// The head's refusal of the current command, which is not repeated.
  const std::optional<Nack>& refusal() const { return refusal_; }
  /// True if all pings of start() are delivered or refused. After stop(): true if the head has stopped or
  /// does not answer.
  bool finished() const { return finished_; }
  const ClientStatistics& statistics() const { return statistics_; }

 private:
  enum class Phase : std::uint8_t {
    meeting,
    idle,
    quieting,  ///< an empty datagram was sent, a scan command follows
    pinging,
    stopping
  };
  /// The arguments of start(), and its progress.
  struct Programme {
    std::variant<Transducer, AutoTransmit> command;
    int step = 0;
    std::uint64_t wanted = 0;
    std::uint64_t delivered = 0;
  };

  void take_frame(TimePoint now, std::span<const std::uint8_t> frame);
  void on_report(TimePoint now, const ProtocolVersion& version);
  void on_report(TimePoint now, const DeviceInformation& information);
  void on_report(TimePoint now, const DeviceData& data);
  void on_report(TimePoint now, const AutoDeviceData& data);
  void on_report(TimePoint now, const Ack& ack);
  void on_report(TimePoint now, const Nack& nack);
  template <class Other>
  void on_report(TimePoint, const Other&) {}  // a client does not need these

  void begin(TimePoint now, const Programme& programme);
  void ask_identity(TimePoint now);
  void ask_for_pings(TimePoint now);
  void order(TimePoint now);
  void deliver(TimePoint now, const Report& report, std::span<const std::uint8_t> data);
  void become_idle();
  void on_timeout(TimePoint now);
  void send(const Command& command);

  FrameBuffer input_;
  HeadIdentity head_;
  Phase phase_ = Phase::meeting;
  std::optional<TimePoint> due_;               ///< time-out of the phase
  std::optional<TimePoint> sign_of_life_due_;  ///< while a scan runs
  int stop_orders_ = 0;
  std::optional<Programme> programme_;
  std::vector<std::uint8_t> last_data_;  ///< the last received DeviceData, as a frame
  std::optional<Nack> refusal_;
  bool finished_ = false;
  std::vector<std::vector<std::uint8_t>> outgoing_;
  std::vector<ReceivedPing> pings_;
  ClientStatistics statistics_;
};

}  // namespace sonard::ping360
