#include "server/replay/log_playback.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <spdlog/spdlog.h>

#include "protocol/gemini/messages.hpp"
#include "renderer/errors.hpp"

namespace sonard::server {
namespace {

constexpr int most_native_lines = 0xFFFF;
constexpr int most_compression_log2 = 4;
constexpr double step_tolerance = 1e-3;  // logs round the rate of lines to whole hertz, the speed to 0.1 m/s

std::vector<std::vector<std::int64_t>> times_of(const std::vector<PlayedHead>& heads) {
  std::vector<std::vector<std::int64_t>> times;
  std::ranges::transform(heads, std::back_inserter(times), &PlayedHead::times_ns);
  return times;
}

class LogRenderer final : public PingRenderer {
 public:
  LogRenderer(const Recording& recording, std::vector<PlayedHead> heads)
      : recording_(recording), heads_(std::move(heads)) {}

  std::string description() const override { return "recording"; }
  bool set_body_pose(const std::string&, const render::Pose&) override { return true; }
  render::PingSamples render_ping(const render::PingRequest& request, int stream) override {
    try {
      return std::visit([&](const auto* head) { return samples_of(*head, request.ping_number); },
                        heads_.at(static_cast<std::size_t>(stream)).recorded);
    } catch (const LogError& error) {
      throw render::RequestError(error.what());
    }
  }
  render::PingStatistics last_statistics() const override { return {}; }

 private:
  render::PingSamples samples_of(const RecordedHead& head, std::uint64_t ping) const {
    const RecordedImage& image = head.images.at(ping);
    render::PingSamples samples;
    samples.beams = image.settings.beams;
    samples.lines = image.settings.lines;
    samples.u8 = recording_.pixels(image);
    return samples;
  }
  render::PingSamples samples_of(const RecordedScan& scan, std::uint64_t ping) const {
    const RecordedScanLine& line = scan.lines.at(ping);
    render::PingSamples samples;
    samples.beams = 1;
    samples.lines = line.settings.lines;
    samples.u8 = recording_.bins(line);
    return samples;
  }

  const Recording& recording_;
  std::vector<PlayedHead> heads_;
};

}  // namespace

std::vector<std::int64_t> PlayedHead::times_ns() const {
  std::vector<std::int64_t> times;
  if (const auto* const head = std::get_if<const RecordedHead*>(&recorded)) {
    std::ranges::transform((*head)->images, std::back_inserter(times), &RecordedImage::time_ns);
  } else {
    const RecordedScan& scan = *std::get<const RecordedScan*>(recorded);
    std::ranges::transform(scan.lines, std::back_inserter(times), &RecordedScanLine::time_ns);
  }
  return times;
}

int PlayedHead::device_id() const {
  return std::visit([](const auto* head) { return int{head->device_id}; }, recorded);
}

std::optional<WireForm> wire_form(const RecordedSettings& settings) {
  const double native_step_m = settings.sound_speed_mps / (2.0 * gemini::line_rate_hz);
  const double lines_per_line = settings.line_step_m / native_step_m;
  const int compression_log2 =
      std::clamp(static_cast<int>(std::lround(std::log2(lines_per_line))), 0, most_compression_log2);
  if (settings.beams != gemini::beam_count || settings.lines < 1 ||
      settings.lines > most_native_lines >> compression_log2) {
    return std::nullopt;
  }
  WireForm form;
  form.ping = {
      .record = 0,
      .lines = settings.lines,
      .compression_log2 = compression_log2,
      .sound_speed_mps = settings.sound_speed_mps,
      .sound_speed_from_config = settings.sound_speed_from_config,
      .gain_percent = settings.gain_percent >= 0.0 ? std::optional(settings.gain_percent) : std::nullopt,
      .due = std::nullopt};
  form.exact = std::abs(lines_per_line / (1 << compression_log2) - 1.0) < step_tolerance;
  return form;
}

LogPlayback::LogPlayback(std::vector<PlayedHead> heads, const ReplayTiming& timing, TimePoint now)
    : schedule_(times_of(heads), timing, now) {
  for (PlayedHead& head : heads) {
    DifferenceLog differences(head.name);
    heads_.push_back({std::move(head), std::move(differences), 0, 0, 0, std::nullopt});
  }
}

std::optional<gemini::RecordedPing> LogPlayback::next_ping(int stream, TimePoint now) {
  const std::optional<ReplaySchedule::Ping> next = schedule_.next(static_cast<std::size_t>(stream), now);
  if (!next) {
    return std::nullopt;
  }
  const RecordedHead& recorded = *std::get<const RecordedHead*>(head(stream).played.recorded);
  gemini::RecordedPing ping = wire_form(recorded.images.at(next->image).settings).value().ping;
  ping.record = next->image;
  ping.due = next->due;
  return ping;
}

std::optional<micron::RecordedLine> LogPlayback::next_line(int stream, TimePoint now) {
  const std::optional<ReplaySchedule::Ping> next = schedule_.next(static_cast<std::size_t>(stream), now);
  if (!next) {
    return std::nullopt;
  }
  const RecordedScan& recorded = *std::get<const RecordedScan*>(head(stream).played.recorded);
  const RecordedScanLine& line = recorded.lines.at(next->image);
  return micron::RecordedLine{.record = next->image,
                              .line = line.wire_line.value(),
                              .bins = line.settings.lines,
                              .bearing_rad = -line.bearing_rad,  // a device counts to starboard
                              .sound_speed_mps = line.settings.sound_speed_mps,
                              .due = next->due};
}

void LogPlayback::started(int stream, const gemini::PingJob& asked) {
  Head& head = this->head(stream);
  const RecordedSettings& recorded =
      std::get<const RecordedHead*>(head.played.recorded)->images.at(*asked.record).settings;
  head.differences.add(differences(asked, wire_form(recorded)->ping, recorded));
  ++head.pings;
  schedule_.started(static_cast<std::size_t>(stream), asked.transmit_time);
}

void LogPlayback::started(int stream, const micron::MicronJob& job, const micron::HeadCommand& asked) {
  Head& head = this->head(stream);
  const RecordedScan& recorded = *std::get<const RecordedScan*>(head.played.recorded);
  head.differences.add(differences(asked, job, *recorded.lines.at(*job.record).wire_line));
  ++head.pings;
  schedule_.started(static_cast<std::size_t>(stream), job.transmit_time);
}

void LogPlayback::progress(int stream, TimePoint now, const gemini::DeviceCounters& done) {
  progress(
      stream, now, done.pings_sent + done.pings_failed + done.pings_cancelled,
      done.lines_sent + done.lines_resent + done.tails_resent + done.heads_resent + done.retries_received);
}

void LogPlayback::progress(int stream, TimePoint now, const micron::DeviceCounters& done) {
  progress(stream, now, done.lines_sent + done.pings_failed + done.pings_cancelled, done.lines_sent);
}

void LogPlayback::progress(int stream, TimePoint now, std::uint64_t ended, std::uint64_t said) {
  Head& head = this->head(stream);
  if (ended < head.pings || said != head.said) {
    head.idle_at = now;
  }
  head.ended = ended;
  head.said = said;
}

bool LogPlayback::finished(TimePoint now) const {
  return schedule_.over(now) && std::ranges::all_of(heads_, [now](const Head& head) {
           return head.ended >= head.pings && (!head.idle_at || now - *head.idle_at >= linger);
         });
}

void LogPlayback::log_totals() const {
  for (const Head& head : heads_) {
    head.differences.log_totals();
  }
  if (schedule_.skipped() > 0) {
    spdlog::info("{} pings of the recording were skipped: nobody wanted them in time", schedule_.skipped());
  }
}

RendererFactory make_log_renderer(const Recording& recording, std::vector<PlayedHead> heads) {
  return [&recording, heads = std::move(heads)] { return std::make_unique<LogRenderer>(recording, heads); };
}

}  // namespace sonard::server
