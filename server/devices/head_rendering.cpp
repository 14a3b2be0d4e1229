// SPDX-License-Identifier: Apache-2.0
#include "server/devices/head_rendering.hpp"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/pose/pose_history.hpp"

namespace sonard::server {
namespace {

/// Pose of a hidden vehicle, beyond the reach of any ping, so that the renderer drops the body. It is always
/// the same pose, so that an unchanged scene stays unchanged. Heads that share a renderer and hide different
/// bodies each move the body for their pings.
const render::Pose out_of_sight{{0.0, 0.0, -1e6}, {1.0, 0.0, 0.0, 0.0}};

}  // namespace

StageSeconds& StageSeconds::operator+=(const render::PingStatistics& ping) {
  visibility += ping.visibility_s;
  binning += ping.binning_s;
  multipath += ping.multipath_s;
  azimuth_pattern += ping.azimuth_pattern_s;
  pulse += ping.pulse_s;
  receiver += ping.receiver_s;
  return *this;
}

HeadRendering::HeadRendering(const HeadConfig& config, int index, const HeadServices& services)
    : config_(config), index_(index), services_(services), load_(config.acoustics, config.adaptive_quality) {
  if (services.poses.ping_clock() != PingClock::wall) {
    ping_times_.emplace(services.poses);
  }
}

bool HeadRendering::begin_ping(TimePoint now, const std::optional<NextPing>& next) {
  if (!next) {
    rest_when_idle(now);
    return false;
  }
  if (next->from > now) {
    return false;
  }
  last_wanted_ = now;
  ping_time_ = ping_times_->begin(next->period, next->listening);
  return ping_time_.has_value();
}

void HeadRendering::rest() {
  if (ping_times_) {
    ping_times_->rest();
  }
}

void HeadRendering::rest_when_idle(TimePoint now) {
  if (submitted_) {
    last_wanted_ = now;
  } else if (now - last_wanted_ > longest_pause) {
    rest();
  }
}

std::optional<std::chrono::nanoseconds> HeadRendering::pose_lead() const {
  return ping_times_ ? ping_times_->lead() : std::nullopt;
}

std::optional<render::Pose> HeadRendering::T_world_mount(TimePoint time) const {
  const std::optional<PoseEstimate> vehicle = services_.poses.at(time);
  if (!vehicle) {
    return std::nullopt;
  }
  return vehicle->T_world_vehicle * config_.T_vehicle_sonar;
}

std::shared_ptr<const PosesUsed> HeadRendering::poses_used(TimePoint transmit_time) const {
  const TimePoint time = pose_time(transmit_time);
  const std::optional<PoseEstimate> vehicle = services_.poses.at(time);
  if (!vehicle) {
    return nullptr;
  }
  return std::make_shared<const PosesUsed>(PosesUsed{transmit_time, vehicle->T_world_vehicle,
                                                     vehicle->T_world_vehicle * config_.T_vehicle_sonar,
                                                     bodies_at(time)});
}

std::vector<PosedBody> HeadRendering::bodies_at(TimePoint time) const {
  std::vector<PosedBody> bodies = services_.poses.bodies_at(time);
  const std::string& model = services_.vehicle_model;
  if (model.empty()) {
    return bodies;
  }
  std::erase_if(bodies, [&](const PosedBody& body) { return body.name == model; });
  const std::optional<PoseEstimate> vehicle = services_.poses.at(time);
  if (vehicle && !config_.hides_vehicle) {
    bodies.push_back({model, vehicle->T_world_vehicle});
  }
  return bodies;
}

void HeadRendering::submit(PingToRender ping, RenderService::Done done) {
  submitted_ = true;
  RenderJob job;
  job.head = index_;
  job.head_name = config_.name;
  job.transmit_us = ping.transmit_us;
  // If poses bring the time, pings wait for them, and the image must depend on nothing else. A recording is
  // played as it is.
  if (!ping_times_ && services_.playback == nullptr) {
    load_.submitted(services_.clock.now(), ping.period);
    ping.settings.sampling.preset = load_.preset();
  }
  job.request = {ping.T_world_sonar, std::move(ping.settings), ping.number, config_.seed,
                 ping.T_world_sonar_at_end};
  job.pose_ns = services_.poses.stamp_at(ping.pose_time);
  job.bodies = bodies_at(ping.pose_time);
  if (config_.hides_vehicle && !services_.vehicle_model.empty()) {
    job.bodies.push_back({services_.vehicle_model, out_of_sight});
  }
  services_.renderer.submit(std::move(job), std::move(done));
}

bool HeadRendering::take(const RenderResult& result) {
  submitted_ = false;
  if (const auto news = load_.answered(services_.clock.now())) {
    spdlog::log(news->level == Notice::Level::warning ? spdlog::level::warn : spdlog::level::info,
                "head={}: {}", config_.name, news->text);
  }
  if (result.error.empty()) {
    ++counters_.pings_rendered;
    const render::PingStatistics& spent = result.statistics;
    counters_.render_seconds +=
        spent.visibility_s + spent.binning_s + spent.azimuth_pattern_s + spent.pulse_s + spent.receiver_s;
    counters_.stages += spent;
    counters_.skipped += spent.skipped;
    newest_ = spent;
    return true;
  }
  if (result.error != last_error_) {
    last_error_ = result.error;
    errors_.error("head={}: cannot render: {}", config_.name, result.error);
  }
  return false;
}

bool HeadRendering::withdraw() {
  if (!services_.skip.on(render::SkipRule::nobody_listening) || !services_.renderer.withdraw(index_)) {
    return false;
  }
  submitted_ = false;
  load_.withdrawn();
  counters_.skipped.add(render::SkipRule::nobody_listening);
  return true;
}

void log_skipped(const std::string& head, const render::SkipCounts& skipped) {
  std::string text;
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    if (const std::uint64_t count = skipped.of(entry.rule); count > 0) {
      text += fmt::format(" {}={}", entry.name, count);
    }
  }
  if (!text.empty()) {
    spdlog::debug("head={}: skipped{}", head, text);
  }
}

double mean_render_ms(const RenderCounters& before, const RenderCounters& now) {
  const std::uint64_t rendered = now.pings_rendered - before.pings_rendered;
  return rendered > 0 ? 1e3 * (now.render_seconds - before.render_seconds) / static_cast<double>(rendered)
                      : 0.0;
}

}  // namespace sonard::server
