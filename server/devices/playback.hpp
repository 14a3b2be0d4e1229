// SPDX-License-Identifier: Apache-2.0
// Interface of a recording that heads play back instead of rendering.
#pragma once

#include <optional>

#include "protocol/common/device.hpp"

namespace sonard::server {

/// A recording that heads play back to clients. `head` is the index of a head. Belongs to the
/// I/O thread.
class Playback {
 public:
  virtual ~Playback() = default;

  /// The next ping of a head at `now`; nullopt: there are no more.
  virtual std::optional<ReplayedPing> next_ping(int head, TimePoint now) = 0;
  /// Called when a ping of next_ping() begins: `job.record`.
  virtual void started(int head, const PingJob& job) = 0;
  /// Called with the progress of a head, whenever it changes.
  virtual void progress(int head, TimePoint now, const PingProgress& done) = 0;
  /// True if everything is sent and clients have had time to request lost messages.
  virtual bool finished(TimePoint now) const = 0;
};

}  // namespace sonard::server
