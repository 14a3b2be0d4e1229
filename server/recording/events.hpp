// SPDX-License-Identifier: Apache-2.0
// Events from heads to the recorder: from the I/O thread to the recorder's thread.
#pragma once

#include <cstddef>
#include <memory>
#include <variant>

#include "protocol/common/ping_record.hpp"
#include "protocol/common/shared_bytes.hpp"
#include "server/clock/clock.hpp"
#include "server/net/wire.hpp"
#include "server/pose/poses_used.hpp"

namespace sonard::server {

/// A ping was sent.
struct PingSent {
  PingRecord ping;
  std::shared_ptr<const PosesUsed> poses;
};

/// A status message of a head whose logs store it (HeadToRecord::glf) was sent.
struct StatusSent {
  SharedBytes message;
};

/// A ping is about to be rendered.
struct PingPosed {
  std::shared_ptr<const PosesUsed> poses;
};

/// A stream has ended.
struct StreamEnded {
  WireEnds ends;
};

struct RecordingEvent {
  int head = 0;      ///< index in the configuration
  TimePoint time{};  ///< time of the event
  std::variant<PingSent, StatusSent, PingPosed, WirePassed, StreamEnded> what;
};

/// Approximate memory of an event, in bytes, for a limit. Shared data counts for each event.
std::size_t memory_of(const RecordingEvent& event);

}  // namespace sonard::server
