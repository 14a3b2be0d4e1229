// A recording as heads play it back: which ping is next, what clients asked for instead, when it is over.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "server/devices/playback.hpp"
#include "server/logs/recording.hpp"
#include "server/render_service.hpp"
#include "server/replay/differences.hpp"
#include "server/replay/replay_schedule.hpp"

namespace sonard::server {

/// How a 720i sends an image of these settings. Lines of a 720i have steps of its own; `exact` says whether
/// those of the recording are among them, or ranges will be wrong on the wire.
struct WireForm {
  gemini::RecordedPing ping;  ///< without record and due
  bool exact = true;
};
/// nullopt where a 720i cannot send it: other than 256 beams, too many lines.
std::optional<WireForm> wire_form(const RecordedSettings& settings);

/// The head of a recording that plays the part of a head of the configuration.
struct PlayedHead {
  std::string name;
  /// Outlives the playback. wire_form() has a form for each image, wire_line is there for each line.
  std::variant<const RecordedHead*, const RecordedScan*> recorded;

  std::vector<std::int64_t> times_ns() const;
  int device_id() const;
};

/// By stream. I/O thread.
class LogPlayback final : public Playback {
 public:
  /// Clients may ask for lost lines of the last ping this long after it, or after the last they asked for.
  static constexpr std::chrono::nanoseconds linger = std::chrono::seconds{2};

  LogPlayback(std::vector<PlayedHead> heads, const ReplayTiming& timing, TimePoint now);

  std::optional<gemini::RecordedPing> next_ping(int stream, TimePoint now) override;
  std::optional<micron::RecordedLine> next_line(int stream, TimePoint now) override;
  void started(int stream, const gemini::PingJob& asked) override;
  void started(int stream, const micron::MicronJob& job, const micron::HeadCommand& asked) override;
  void progress(int stream, TimePoint now, const gemini::DeviceCounters& done) override;
  void progress(int stream, TimePoint now, const micron::DeviceCounters& done) override;
  bool finished(TimePoint now) const override;

  /// Once, at the end.
  void log_totals() const;

 private:
  struct Head {
    PlayedHead played;
    DifferenceLog differences;
    std::uint64_t pings = 0;           ///< begun
    std::uint64_t ended = 0;           ///< of those, at the last progress()
    std::uint64_t said = 0;            ///< packets, at the last progress()
    std::optional<TimePoint> idle_at;  ///< last time at which the head had something to send
  };

  Head& head(int stream) { return heads_.at(static_cast<std::size_t>(stream)); }
  void progress(int stream, TimePoint now, std::uint64_t ended, std::uint64_t said);

  std::vector<Head> heads_;
  mutable ReplaySchedule schedule_;  ///< forgets what is missed as time goes by
};

/// In place of the renderer: hands out the samples of the record that a ping's number names. Render thread.
RendererFactory make_log_renderer(const Recording& recording, std::vector<PlayedHead> heads);

}  // namespace sonard::server
