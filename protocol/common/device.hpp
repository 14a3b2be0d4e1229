// SPDX-License-Identifier: Apache-2.0
// The interface of every emulated head: a state machine that takes events and returns actions. It uses no
// sockets, clocks or threads.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/common/endpoint.hpp"
#include "protocol/common/ping_job.hpp"
#include "protocol/common/ping_record.hpp"
#include "protocol/common/shared_bytes.hpp"

namespace sonard {

/// The other end of a message. Default-constructed on a line that all clients share, such as a serial line.
struct Peer {
  int channel = 0;  ///< number of the device's socket or line; each device type has its own numbering
  Endpoint remote;  ///< the sender or the receiver
  Ipv4 local = 0;   ///< our address that received the message or must send it; 0: any

  bool operator==(const Peer&) const = default;
};

// ---- What happens to a device

/// A datagram, or any part of a stream.
struct BytesReceived {
  Peer from;
  SharedBytes bytes;
};
/// A client has connected and its own stream begins. Only connection-oriented transports send this event.
struct ClientCame {
  Peer who;
};
/// A client has disconnected. The rest of an incomplete message will not arrive.
struct ClientGone {
  Peer who;
};
/// The image of the outstanding job. If that ping was cancelled meanwhile, the device counts and drops it.
struct PingRendered {
  PingImage image;
};
/// The outstanding job cannot be rendered, or was withdrawn. The head continues without this ping.
struct PingNotRendered {
  std::uint64_t number = 0;
};
/// One edge at the external trigger input.
struct TriggerEdge {};
/// The head has left or entered the water.
struct WaterChanged {
  bool out_of_water = false;
};
/// The current sensor readings of the head, for messages that belong to no ping.
struct SensorsRead {
  SensorReadings readings;
};
/// Feeds a device that plays back: the ping to send at a client's next request. It replaces the ping fed
/// before. One job consumes it; without a fed ping, no ping begins.
struct PingFed {
  std::optional<ReplayedPing> ping;
};
/// In simulated time: the poses of Actions::next_ping have arrived, so it begins with this step. It is never
/// sent before NextPing::from.
struct NextPingDue {};
/// The time Actions::wake_at has been reached without another event.
struct TimePassed {};

using Event = std::variant<TimePassed, BytesReceived, ClientCame, ClientGone, PingRendered, PingNotRendered,
                           TriggerEdge, WaterChanged, SensorsRead, PingFed, NextPingDue>;

// ---- What a device requests

/// A message to send now.
struct Outgoing {
  enum class To : std::uint8_t {
    peer,      ///< to the member `peer`
    everybody  ///< to all clients of a shared line, or as a broadcast
  };
  To to = To::peer;
  Peer peer;
  SharedBytes bytes;
};

/// A line for the program's log: "client 192.168.2.5 connected".
struct Notice {
  enum class Level : std::uint8_t { info, warning };
  Level level = Level::info;
  std::string text;
};

/// The answer to one event. The lists belong to this event; the other members are the state after it.
struct Actions {
  std::vector<Outgoing> send;  ///< in order
  /// Clients to disconnect after `send` has been sent. ClientGone follows.
  std::vector<Peer> disconnect;
  /// A ping to render. At most one job is outstanding. Each job is answered once, by PingRendered or
  /// PingNotRendered, before the next.
  std::optional<PingJob> render;
  std::optional<PingRecord> record;  ///< set when a ping goes onto the wire
  std::vector<Notice> notices;
  /// Set if a client's command was for another head: what it asked for, in whole sentences.
  std::optional<std::string> misaddressed;

  /// Number of the outstanding job, if its image is no longer needed. The job must still be answered, by
  /// PingNotRendered without rendering if possible.
  std::optional<std::uint64_t> cancelled;
  std::optional<NextPing> next_ping;  ///< only in simulated time
  bool nobody_there = false;          ///< no client requests pings: it has just gone, or there is no client
  /// When to step next if no other event comes; later than this step. nullopt: only after an event.
  std::optional<TimePoint> wake_at;
};

/// A counter of a device or its transport, for log, status and docs/events.md. It only grows.
struct Counter {
  enum class Fault : std::uint8_t {
    none,
    of_client,  ///< a client sent something that the head refuses, ignores or changes
  };
  enum class Shown : std::uint8_t {
    at_end,  ///< in the totals
    once,    ///< in the totals; a notice has warned of the first event of each kind
    often,   ///< also in the lines about rates, if it has grown
    warns,   ///< in the totals and, if it has grown, as a warning with the text of `warning`
  };
  std::string name;  ///< "lines_resent"; empty: not in the totals
  std::uint64_t value = 0;
  std::string_view meaning =
      {};  ///< the events, and the reaction of the head: "commands for another node, ignored"
  Fault fault = Fault::none;
  Shown shown = Shown::at_end;
  std::string warning = {};  ///< "{} commands were for another node"
};

/// Counters of a head's pings. They only grow.
struct PingProgress {
  std::uint64_t sent = 0;      ///< pings sent completely
  std::uint64_t ended = 0;     ///< pings sent completely, failed or cancelled
  std::uint64_t messages = 0;  ///< messages that carried pings, with repetitions, and requests to repeat
};

/// One head. Not thread-safe. `now` never goes backwards over all calls.
class Device {
 public:
  Device() = default;
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Handles an event and runs everything that is due. After a late call the device catches up if it can.
  virtual Actions step(TimePoint now, const Event& event) = 0;

  virtual PingProgress progress() const = 0;
  virtual std::vector<Counter> counts() const = 0;
};

}  // namespace sonard
