// SPDX-License-Identifier: Apache-2.0
// The interface of every emulated head: a state machine that takes events and answers with actions. It knows
// no sockets, clocks or threads.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "protocol/common/endpoint.hpp"
#include "protocol/common/ping_job.hpp"
#include "protocol/common/ping_record.hpp"
#include "protocol/common/shared_bytes.hpp"

namespace sonard {

/// The other end of a message. On a line that all clients share, as a serial one, it is the default.
struct Peer {
  int channel = 0;  ///< which of the device's sockets or lines, as its kind numbers them
  Endpoint remote;  ///< where it came from or goes to
  Ipv4 local = 0;   ///< the address of ours that it came to, or is to come from; 0: any

  bool operator==(const Peer&) const = default;
};

// ---- What happens to a device

/// A datagram, or any piece of a stream.
struct BytesReceived {
  Peer from;
  SharedBytes bytes;
};
/// A client has connected, where the transport knows of such a thing: a stream of its own has begun.
struct ClientCame {
  Peer who;
};
/// A client has gone: the rest of a message that it had begun will not come.
struct ClientGone {
  Peer who;
};
/// The image of the outstanding job. It is counted and dropped if that ping was cancelled meanwhile.
struct PingRendered {
  PingImage image;
};
/// The outstanding job cannot be rendered, or was withdrawn: the head continues without this ping.
struct PingNotRendered {
  std::uint64_t number = 0;
};
/// One edge at the external trigger input.
struct TriggerEdge {};
/// The head has left the water, or is back in it.
struct WaterChanged {
  bool out_of_water = false;
};
/// What the sensors of the head read now, for messages that belong to no ping.
struct SensorsRead {
  SensorReadings readings;
};
/// Feeds a device that plays back: the ping to send when a client next wants one. It replaces the one fed
/// before and is used up by one job; without one no ping begins.
struct PingFed {
  std::optional<RecordedPing> ping;
};
/// Grants Actions::next_ping to a device that waits for grants. It is not sent before NextPing::from.
struct PingGranted {};
/// Actions::wake_at has come, and nothing else has happened.
struct TimePassed {};

using Event = std::variant<TimePassed, BytesReceived, ClientCame, ClientGone, PingRendered, PingNotRendered,
                           TriggerEdge, WaterChanged, SensorsRead, PingFed, PingGranted>;

// ---- What a device wants done

/// A message to send now.
struct Outgoing {
  enum class To : std::uint8_t {
    peer,      ///< to the one below
    everybody  ///< to all who listen: the clients of a shared line, or a broadcast
  };
  To to = To::peer;
  Peer peer;
  SharedBytes bytes;
};

/// A line for the program's log: "topside 192.168.2.5 connected".
struct Notice {
  enum class Level : std::uint8_t { info, warning };
  Level level = Level::info;
  std::string text;
};

/// The answer to one event. The lists belong to that event; the other members are the state after it.
struct Actions {
  std::vector<Outgoing> send;  ///< in order
  /// Clients whose connections are to be closed, behind what is sent to them. ClientGone follows.
  std::vector<Peer> disconnect;
  /// A ping to render. Each is answered once, by PingRendered or PingNotRendered, and the next waits for
  /// that: at most one job is outstanding.
  std::optional<PingJob> render;
  std::optional<PingRecord> record;  ///< a ping goes onto the wire
  std::vector<Notice> notices;

  /// The outstanding job, where its image is no longer wanted. It must still be answered, by PingNotRendered
  /// without rendering if possible.
  std::optional<std::uint64_t> cancelled;
  std::optional<NextPing> next_ping;  ///< for a device that waits for grants
  bool nobody_there = false;          ///< no client wants pings: it has just gone, or none is known
  /// When to step next without another event; later than this step. nullopt: only after an event.
  std::optional<TimePoint> wake_at;
};

/// A count of a device or its transport, for the log. It only grows.
struct Counter {
  enum class Shown : std::uint8_t {
    at_end,  ///< in the totals
    often,   ///< also in the lines about rates, where it has grown
    warns,   ///< in the totals, and as a warning with the text below where it has grown
  };
  std::string name;  ///< "lines_resent"; empty: it is not among the totals
  std::uint64_t value = 0;
  Shown shown = Shown::at_end;
  std::string warning = {};  ///< "{} commands were for another node"
};

/// What a head has done with its pings. They only grow.
struct PingProgress {
  std::uint64_t sent = 0;      ///< pings that went out to their end
  std::uint64_t ended = 0;     ///< those, and those that failed or were cancelled
  std::uint64_t messages = 0;  ///< that carried them, repeated ones too, and requests for such
};

/// One head. Not thread-safe. `now` never goes backwards over all calls.
class Device {
 public:
  Device() = default;
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Takes an event and runs everything that is due. After a late call the device catches up as it can.
  virtual Actions step(TimePoint now, const Event& event) = 0;

  virtual PingProgress progress() const = 0;
  virtual std::vector<Counter> counts() const = 0;
};

}  // namespace sonard
