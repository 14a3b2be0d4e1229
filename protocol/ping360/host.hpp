// SPDX-License-Identifier: Apache-2.0
// The client's side of a Ping360 as a pure state machine: bytes and time go in; frames and pings come out. It
// knows no serial ports, sockets, clocks or threads. Source: docs/protocols/ping360.md 3, 6.
//
// It goes the way of known clients: asks for protocol version, identity and state, then either commands one
// ping after another and waits for each, or starts a scan and listens. What does not come is asked for again.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "protocol/ping360/frame.hpp"
#include "protocol/ping360/messages.hpp"
#include "protocol/ping360/ping_form.hpp"

namespace sonard::ping360 {

/// What a head has said of itself.
struct HeadIdentity {
  std::optional<ProtocolVersion> protocol;
  std::optional<DeviceInformation> information;
  std::optional<PingForm> state;  ///< at the beginning
};

struct ReceivedPing {
  std::uint64_t number = 0;  ///< 0, 1, 2, ... in the order of delivery
  TimePoint received{};
  PingForm form;
  std::vector<std::uint8_t> samples;  ///< from near to far
};

/// Counters since construction. They only grow.
struct HostStatistics {
  std::uint64_t frames = 0;         ///< with a right checksum
  std::uint64_t dropped_bytes = 0;  ///< part of no frame
  std::uint64_t bad_frames = 0;     ///< could not be read
  std::uint64_t pings = 0;          ///< delivered
  /// Of another scan, second copies, or none was asked for; not those sent before a stop was read.
  std::uint64_t pings_unwanted = 0;
  std::uint64_t commands = 0;  ///< that ask for pings, the first time and again
  std::uint64_t timeouts = 0;  ///< commands that no ping came for
};

/// Not thread-safe: one thread calls everything. `now` never goes backwards.
class Host {
 public:
  explicit Host(TimePoint now);

  /// Bytes from the head, cut as they happen to come. Bad ones are counted and dropped.
  void on_bytes(TimePoint now, std::span<const std::uint8_t> bytes);

  /// Pings with these settings, each time `step` gradians on, at once or as soon as the head is known;
  /// replaces what was going on. Ends after `pings` delivered ones; 0: goes on until stop().
  void start(TimePoint now, const Transducer& first, int step, std::uint64_t pings);
  /// Scans; all else as above.
  void start(TimePoint now, const AutoTransmit& scan, std::uint64_t pings);
  /// Asks for nothing more, and tells the head to stop until it says that it has.
  void stop(TimePoint now);

  /// Runs everything due at `now`. Call after every other call and at next_deadline().
  void advance(TimePoint now);
  /// When advance() is next needed; nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const;

  /// Frames due, in order, each a datagram of its own; an empty one, too, is sent over UDP and left out on
  /// other lines. Each call empties the list.
  std::vector<std::vector<std::uint8_t>> take_outgoing();
  /// Pings that came, in order. Each call empties the list.
  std::vector<ReceivedPing> take_pings();

  const HeadIdentity& head() const { return head_; }
  /// What the head has answered to the present command instead of a ping. It is not asked again.
  const std::optional<Nack>& refusal() const { return refusal_; }
  /// All pings asked for by start() are delivered or refused; after stop(): the head has stopped, or does
  /// not answer.
  bool finished() const { return finished_; }
  const HostStatistics& statistics() const { return statistics_; }

 private:
  enum class Phase : std::uint8_t {
    meeting,
    idle,
    quieting,  ///< an empty datagram was sent, a scan will be ordered
    pinging,
    stopping
  };
  /// What start() asked for.
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
  void on_report(TimePoint, const Other&) {}  // nothing that a client needs

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
  std::optional<TimePoint> due_;               ///< when what the phase waits for is given up
  std::optional<TimePoint> sign_of_life_due_;  ///< while a scan goes on
  int stop_orders_ = 0;
  std::optional<Programme> programme_;
  std::vector<std::uint8_t> last_data_;  ///< the last DeviceData that came, as a frame
  std::optional<Nack> refusal_;
  bool finished_ = false;
  std::vector<std::vector<std::uint8_t>> outgoing_;
  std::vector<ReceivedPing> pings_;
  HostStatistics statistics_;
};

}  // namespace sonard::ping360
