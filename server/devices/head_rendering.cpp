#include "server/devices/head_rendering.hpp"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/pose/pose_history.hpp"

namespace sonard::server {

std::optional<render::Pose> HeadRendering::T_world_mount(TimePoint time) const {
  const std::optional<PoseEstimate> vehicle = services_.poses.at(time);
  if (!vehicle) {
    return std::nullopt;
  }
  return vehicle->T_world_vehicle * config_.T_vehicle_sonar;
}

std::shared_ptr<const PosesUsed> HeadRendering::poses_used(TimePoint time) const {
  const std::optional<PoseEstimate> vehicle = services_.poses.at(time);
  if (!vehicle) {
    return nullptr;
  }
  return std::make_shared<const PosesUsed>(PosesUsed{time, vehicle->T_world_vehicle,
                                                     vehicle->T_world_vehicle * config_.T_vehicle_sonar,
                                                     services_.poses.bodies_at(time)});
}

void HeadRendering::submit(HeadPing ping, RenderService::Done done) const {
  RenderJob job;
  job.stream = stream_;
  job.head = config_.name;
  job.transmit_us = ping.transmit_us;
  job.request = {ping.T_world_sonar, std::move(ping.settings), ping.number, config_.seed,
                 ping.T_world_sonar_at_end};
  job.bodies = services_.poses.bodies_at(ping.transmit_time);
  services_.renderer.submit(std::move(job), std::move(done));
}

bool HeadRendering::take(const RenderResult& result) {
  if (result.error.empty()) {
    ++counters_.pings_rendered;
    const render::PingStatistics& spent = result.statistics;
    counters_.render_seconds +=
        spent.visibility_s + spent.binning_s + spent.azimuth_pattern_s + spent.pulse_s + spent.receiver_s;
    counters_.skipped += spent.skipped;
    return true;
  }
  if (result.error != last_error_) {
    last_error_ = result.error;
    spdlog::error("head={} cannot render: {}", config_.name, result.error);
  }
  return false;
}

bool HeadRendering::withdraw() {
  if (!services_.skip.on(render::SkipRule::nobody_listening) || !services_.renderer.withdraw(stream_)) {
    return false;
  }
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
    spdlog::info("head={} skipped:{}", head, text);
  }
}

double mean_render_ms(const RenderCounters& before, const RenderCounters& now) {
  const std::uint64_t rendered = now.pings_rendered - before.pings_rendered;
  return rendered > 0 ? 1e3 * (now.render_seconds - before.render_seconds) / static_cast<double>(rendered)
                      : 0.0;
}

}  // namespace sonard::server
