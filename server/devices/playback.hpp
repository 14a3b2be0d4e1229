// What heads play back instead of having it rendered.
#pragma once

#include <optional>

#include "protocol/gemini/device_counters.hpp"
#include "protocol/gemini/ping_job.hpp"
#include "server/clock.hpp"

namespace sonard::server {

/// A recording on its way to clients. `stream` is the number of a head, as in HeadServices. All calls come
/// from the I/O thread.
class Playback {
 public:
  virtual ~Playback() = default;

  /// For Device::offer(): the next ping of a head as things stand at `now`; nullopt: it has no more.
  virtual std::optional<gemini::RecordedPing> next(int stream, TimePoint now) = 0;
  /// A ping that next() has named begins, `asked.record`, in answer to what `asked` says.
  virtual void started(int stream, const gemini::PingJob& asked) = 0;
  /// What a head has done so far, whenever it has done something.
  virtual void progress(int stream, TimePoint now, const gemini::DeviceCounters& done) = 0;
  /// Everything is sent, and whoever wanted lost lines again has had the time to ask.
  virtual bool finished(TimePoint now) const = 0;
};

}  // namespace sonard::server
