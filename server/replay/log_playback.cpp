// SPDX-License-Identifier: Apache-2.0
#include "server/replay/log_playback.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "renderer/errors.hpp"

namespace sonard::server {
namespace {

std::vector<std::vector<std::int64_t>> times_of(const std::vector<PlayedHead>& heads) {
  std::vector<std::vector<std::int64_t>> times;
  std::ranges::transform(heads, std::back_inserter(times), &PlayedHead::times_ns);
  return times;
}

class LogRenderer final : public PingRenderer {
 public:
  LogRenderer(const LogReader& reader, std::vector<PlayedHead> heads)
      : reader_(reader), heads_(std::move(heads)) {}

  std::string description() const override { return "recording"; }
  bool set_body_pose(const std::string&, const render::Pose&) override { return true; }
  render::PingSamples render_ping(const render::PingRequest& request, int head) override {
    try {
      return samples_of(*heads_.at(static_cast<std::size_t>(head)).logged, request.ping_number);
    } catch (const Error& error) {
      throw render::RequestError(error.what());
    }
  }
  render::PingStatistics last_statistics() const override { return {}; }

 private:
  render::PingSamples samples_of(const LoggedHead& head, std::uint64_t number) const {
    const LoggedPing& ping = head.pings.at(number);
    render::PingSamples samples;
    samples.beams = ping.settings.beams;
    samples.bins = ping.settings.bins;
    samples.u8 = reader_.samples(ping);
    return samples;
  }

  const LogReader& reader_;
  std::vector<PlayedHead> heads_;
};

}  // namespace

std::vector<std::int64_t> PlayedHead::times_ns() const {
  std::vector<std::int64_t> times;
  std::ranges::transform(logged->pings, std::back_inserter(times), &LoggedPing::time_ns);
  return times;
}

LogPlayback::LogPlayback(std::vector<PlayedHead> heads, const ReplayTiming& timing, TimePoint now)
    : schedule_(times_of(heads), timing, now) {
  for (PlayedHead& head : heads) {
    heads_.push_back({.played = std::move(head), .differences = {}});
  }
}

std::optional<ReplayedPing> LogPlayback::next_ping(int index, TimePoint now) {
  const std::optional<ReplaySchedule::Ping> next = schedule_.next(static_cast<std::size_t>(index), now);
  if (!next) {
    return std::nullopt;
  }
  const LoggedPing& ping = head(index).played.logged->pings.at(next->image);
  return ReplayedPing{.record = next->image,
                      .settings = ping.settings,
                      .bearing_rad = ping.bearing_rad,
                      .bits_per_bin = ping.bits_per_bin,
                      .wire = ping.wire,
                      .due = next->due};
}

void LogPlayback::started(int index, const PingJob& job) {
  Head& head = this->head(index);
  for (const Difference& difference : job.differences) {
    count(head, difference);
  }
  ++head.pings;
  schedule_.started(static_cast<std::size_t>(index), job.transmit_time);
}

// Logs only the first difference of each kind.
void LogPlayback::count(Head& head, const Difference& difference) {
  const auto known =
      std::ranges::find(head.differences, difference.kind, &std::pair<std::string, std::uint64_t>::first);
  if (known != head.differences.end()) {
    ++known->second;
  } else {
    head.differences.emplace_back(difference.kind, 1);
    spdlog::warn("head={}: differs from the recording: {}", head.played.name, difference.text);
  }
}

void LogPlayback::progress(int index, TimePoint now, const PingProgress& done) {
  Head& head = this->head(index);
  if (done.ended < head.pings || done.messages != head.messages) {
    head.idle_at = now;
  }
  head.ended = done.ended;
  head.messages = done.messages;
}

bool LogPlayback::finished(TimePoint now) const {
  return schedule_.over(now) && std::ranges::all_of(heads_, [now](const Head& head) {
           return head.ended >= head.pings && (!head.idle_at || now - *head.idle_at >= linger);
         });
}

void LogPlayback::log_totals() const {
  for (const Head& head : heads_) {
    std::string text;
    for (const auto& [kind, pings] : head.differences) {
      text += fmt::format(" {}={}", kind, pings);
    }
    if (!text.empty()) {
      spdlog::info("head={}: pings that differ from the request:{}", head.played.name, text);
    }
  }
  if (schedule_.skipped() > 0) {
    spdlog::info("replay: {} pings of the recording were skipped, because no client requested them in time",
                 schedule_.skipped());
  }
}

RendererFactory make_log_renderer(const LogReader& reader, std::vector<PlayedHead> heads) {
  return [&reader, heads = std::move(heads)] { return std::make_unique<LogRenderer>(reader, heads); };
}

}  // namespace sonard::server
