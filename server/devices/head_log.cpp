// SPDX-License-Identifier: Apache-2.0
#include "server/devices/head_log.hpp"

#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace sonard::server {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

std::uint64_t value_before(const std::vector<Counter>& before, std::size_t index) {
  return index < before.size() ? before[index].value : 0;
}

std::string counters_text(const std::vector<Counter>& counters) {
  std::string text;
  for (const Counter& counter : counters) {
    if (!counter.name.empty()) {
      text += fmt::format(" {}={}", counter.name, counter.value);
    }
  }
  return text;
}

/// " unknown_type=3 refused=1"; empty: no client caused a fault.
std::string client_faults_text(const std::vector<Counter>& counters) {
  std::string text;
  for (const Counter& counter : counters) {
    if (counter.fault == Counter::Fault::of_client && counter.value > 0) {
      text += fmt::format(" {}={}", counter.name, counter.value);
    }
  }
  return text;
}

/// Growth of the counters that are logged while the head runs.
std::string growth_text(const std::vector<Counter>& before, const std::vector<Counter>& now) {
  std::string text;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (now[i].shown == Counter::Shown::often) {
      text += fmt::format(" {}={}", now[i].name, now[i].value - value_before(before, i));
    }
  }
  return text;
}

}  // namespace

void HeadLog::notice(const Notice& notice) {
  if (notice.level == Notice::Level::warning) {
    notices_.warn("head={}: {}", head_, notice.text);
  } else {
    notices_.info("head={}: {}", head_, notice.text);
  }
}

void HeadLog::settings(const PingJob& job) {
  if (job.settings == settings_) {
    return;
  }
  settings_ = job.settings;
  std::string text;
  for (const Setting& setting : settings_) {
    text += fmt::format(" {}={}", setting.name, setting.value);
  }
  setting_changes_.info("head={}: pings{}", head_, text);
}

void HeadLog::ping(const PingJob& job, bool turns, const render::Pose& T_world_sonar) {
  settings(job);
  const glm::dvec3& p = T_world_sonar.position_m;
  const glm::dvec3 axis = T_world_sonar.orientation * glm::dvec3(1, 0, 0);
  const std::string bearing = turns ? fmt::format(" bearing={:.3f}deg", job.bearing_rad / degree) : "";
  spdlog::debug(
      "head={}: ping number={}{} transmit_us={} position_m=[{:.3f}, {:.3f}, {:.3f}] axis=[{:.4f}, {:.4f}, "
      "{:.4f}]",
      head_, job.number, bearing, job.transmit_us, p.x, p.y, p.z, axis.x, axis.y, axis.z);
}

void HeadLog::rates(const HeadCounts& total, std::chrono::duration<double> period) {
  const HeadCounts before = std::exchange(reported_, total);
  if (const std::uint64_t sent = total.pings.sent - before.pings.sent; sent > 0) {
    spdlog::info("head={}: pings_per_s={:.1f} render_ms={:.2f}{}", head_,
                 static_cast<double>(sent) / period.count(),
                 mean_render_ms(before.rendering, total.rendering), growth_text(before.device, total.device));
  }
  log_skipped(head_, total.rendering.skipped - before.rendering.skipped);
  const std::uint64_t missed = total.rendering.pings_without_pose - before.rendering.pings_without_pose;
  if (missed > 0) {
    spdlog::warn("head={}: {} pings not made: no pose, or the last one is too old", head_, missed);
  }
  warn_of(before.device, total.device);
  warn_of(before.transport, total.transport);
}

void HeadLog::warn_of(const std::vector<Counter>& before, const std::vector<Counter>& now) const {
  for (std::size_t i = 0; i < now.size(); ++i) {
    const std::uint64_t growth = now[i].value - value_before(before, i);
    if (now[i].shown == Counter::Shown::warns && growth > 0) {
      spdlog::warn("head={}: {}", head_, fmt::format(fmt::runtime(now[i].warning), growth));
    }
  }
}

void HeadLog::totals(const HeadCounts& total) const {
  spdlog::info("head={}: ended{} render_ms={:.2f} pings_without_pose={}", head_, counters_text(total.device),
               mean_render_ms({}, total.rendering), total.rendering.pings_without_pose);
  spdlog::info("head={}: transport{}", head_, counters_text(total.transport));
  log_skipped(head_, total.rendering.skipped);
  warn_of(reported_.device, total.device);
  warn_of(reported_.transport, total.transport);
  if (const std::string faults = client_faults_text(total.device); !faults.empty()) {
    spdlog::warn("head={}: client faults{} (docs/events.md)", head_, faults);
  }
}

}  // namespace sonard::server
