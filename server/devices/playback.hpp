// SPDX-License-Identifier: Apache-2.0
// The interface of a recording that heads play back instead of rendering.
#pragma once

#include <optional>

#include "protocol/common/device.hpp"

namespace sonard::server {

/// A recording that heads play back to clients. `stream` is the number of a head, as in HeadServices. All
/// calls come from the I/O thread.
class Playback {
 public:
  virtual ~Playback() = default;

  /// The next ping of a head at `now`; nullopt: it has no more.
  virtual std::optional<RecordedPing> next_ping(int stream, TimePoint now) = 0;
  /// A ping that next_ping() has named begins: `job.record`.
  virtual void started(int stream, const PingJob& job) = 0;
  /// Reports what a head has done so far, whenever that changes.
  virtual void progress(int stream, TimePoint now, const PingProgress& done) = 0;
  /// Everything is sent, and clients have had the time to ask for lost messages.
  virtual bool finished(TimePoint now) const = 0;
};

}  // namespace sonard::server
