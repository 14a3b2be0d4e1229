// SPDX-License-Identifier: Apache-2.0
// What heads tell the recorder, from the I/O thread to the recorder's thread.
#pragma once

#include <cstddef>
#include <memory>
#include <variant>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/common/shared_bytes.hpp"
#include "renderer/pose.hpp"
#include "server/clock/clock.hpp"
#include "server/net/wire.hpp"
#include "server/pose/posed_body.hpp"

namespace sonard::server {

/// Where everything was for one ping.
struct PosesUsed {
  TimePoint time{};  ///< of the transmission
  render::Pose T_world_vehicle;
  render::Pose T_world_sonar;     ///< of the mount
  std::vector<PosedBody> bodies;  ///< those received so far
};

/// A ping goes onto the wire.
struct PingSent {
  PingRecord ping;
  std::shared_ptr<const PosesUsed> poses;
};

/// A message goes to everybody: the status of a head whose logs keep that (HeadToRecord::glf_status).
struct StatusSent {
  SharedBytes message;
};

/// A ping is about to be rendered.
struct PingPosed {
  std::shared_ptr<const PosesUsed> poses;
};

/// A stream has come to its end.
struct StreamEnded {
  WireEnds ends;
};

struct RecordingEvent {
  int head = 0;      ///< its place in the configuration
  TimePoint time{};  ///< when it happened
  std::variant<PingSent, StatusSent, PingPosed, WirePassed, StreamEnded> what;
};

/// Bytes of memory that an event holds, near enough for a bound. What events share counts for each.
std::size_t memory_of(const RecordingEvent& event);

}  // namespace sonard::server
