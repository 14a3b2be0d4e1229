#include "server/replay/log_playback.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/spdlog.h>

#include "protocol/gemini/messages.hpp"
#include "renderer/errors.hpp"

namespace sonard::server {
namespace {

constexpr int most_native_lines = 0xFFFF;
constexpr int most_compression_log2 = 4;
constexpr double step_tolerance = 1e-3;  // logs round the rate of lines to whole hertz, the speed to 0.1 m/s

bool did_something(const gemini::DeviceCounters& before, const gemini::DeviceCounters& now) {
  return before.lines_sent != now.lines_sent || before.lines_resent != now.lines_resent ||
         before.tails_resent != now.tails_resent || before.heads_resent != now.heads_resent ||
         before.retries_received != now.retries_received;
}

std::vector<std::vector<std::int64_t>> times_of(const std::vector<PlayedHead>& heads) {
  std::vector<std::vector<std::int64_t>> times;
  for (const PlayedHead& head : heads) {
    std::vector<std::int64_t>& of_head = times.emplace_back();
    for (const RecordedImage& image : head.recorded->images) {
      of_head.push_back(image.time_ns);
    }
  }
  return times;
}

class LogRenderer final : public PingRenderer {
 public:
  LogRenderer(const Recording& recording, std::vector<PlayedHead> heads)
      : recording_(recording), heads_(std::move(heads)) {}

  std::string description() const override { return "recording"; }
  bool set_body_pose(const std::string&, const render::Pose&) override { return true; }
  render::PingSamples render_ping(const render::PingRequest& request, int stream) override {
    const auto& images = heads_.at(static_cast<std::size_t>(stream)).recorded->images;
    const RecordedImage& image = images.at(request.ping_number);
    render::PingSamples samples;
    samples.beams = image.settings.beams;
    samples.lines = image.settings.lines;
    try {
      samples.u8 = recording_.pixels(image);
    } catch (const LogError& error) {
      throw render::RequestError(error.what());
    }
    return samples;
  }
  render::PingStatistics last_statistics() const override { return {}; }

 private:
  const Recording& recording_;
  std::vector<PlayedHead> heads_;
};

}  // namespace

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
    heads_.push_back({head.recorded, DifferenceLog(std::move(head.name)), 0, {}, std::nullopt});
  }
}

std::optional<gemini::RecordedPing> LogPlayback::next(int stream, TimePoint now) {
  const auto index = static_cast<std::size_t>(stream);
  const std::optional<ReplaySchedule::Ping> ping = schedule_.next(index, now);
  if (!ping) {
    return std::nullopt;
  }
  std::optional<WireForm> form = wire_form(heads_.at(index).recorded->images.at(ping->image).settings);
  if (!form) {
    return std::nullopt;  // PlayedHead rules it out
  }
  form->ping.record = ping->image;
  form->ping.due = ping->due;
  return form->ping;
}

void LogPlayback::started(int stream, const gemini::PingJob& asked) {
  const auto index = static_cast<std::size_t>(stream);
  Head& head = heads_.at(index);
  const RecordedSettings& recorded = head.recorded->images.at(*asked.record).settings;
  head.differences.add(asked, wire_form(recorded)->ping, recorded);
  ++head.pings;
  schedule_.started(index, asked.transmit_time);
}

void LogPlayback::progress(int stream, TimePoint now, const gemini::DeviceCounters& done) {
  Head& head = heads_.at(static_cast<std::size_t>(stream));
  const bool pinging = done.pings_sent + done.pings_failed + done.pings_cancelled < head.pings;
  if (pinging || did_something(head.done, done)) {
    head.idle_at = now;
  }
  head.done = done;
}

bool LogPlayback::finished(TimePoint now) const {
  return schedule_.over(now) && std::ranges::all_of(heads_, [now](const Head& head) {
           const gemini::DeviceCounters& done = head.done;
           return done.pings_sent + done.pings_failed + done.pings_cancelled >= head.pings &&
                  (!head.idle_at || now - *head.idle_at >= linger);
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
