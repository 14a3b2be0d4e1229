// What heads play back instead of having it rendered.
#pragma once

#include <optional>

#include "protocol/gemini/device_counters.hpp"
#include "protocol/gemini/ping_job.hpp"
#include "protocol/micron/device_counters.hpp"
#include "protocol/micron/messages.hpp"
#include "protocol/micron/micron_job.hpp"
#include "server/clock.hpp"

namespace sonard::server {

/// A recording on its way to clients. `stream` is the number of a head, as in HeadServices. All calls come
/// from the I/O thread.
class Playback {
 public:
  virtual ~Playback() = default;

  /// For Device::offer(): the next ping of a head as things stand at `now`; nullopt: it has no more.
  virtual std::optional<gemini::RecordedPing> next_ping(int stream, TimePoint now) = 0;
  virtual std::optional<micron::RecordedLine> next_line(int stream, TimePoint now) = 0;
  /// A ping that next_ping() has named begins, `asked.record`, in answer to what `asked` says.
  virtual void started(int stream, const gemini::PingJob& asked) = 0;
  /// A ping that next_line() has named begins, `job.record`, for a host that had told the head `asked`.
  virtual void started(int stream, const micron::MicronJob& job, const micron::HeadCommand& asked) = 0;
  /// What a head has done so far, whenever it has done something.
  virtual void progress(int stream, TimePoint now, const gemini::DeviceCounters& done) = 0;
  virtual void progress(int stream, TimePoint now, const micron::DeviceCounters& done) = 0;
  /// Everything is sent, and whoever wanted lost lines again has had the time to ask.
  virtual bool finished(TimePoint now) const = 0;
};

}  // namespace sonard::server
