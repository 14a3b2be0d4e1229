// SPDX-License-Identifier: Apache-2.0
#include "server/replay/replay_config.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "server/devices/types/types.hpp"

namespace sonard::server {
namespace {

constexpr Ipv4 first_loopback_head = 0x7F000002;
constexpr std::chrono::hours day{24};
constexpr std::chrono::nanoseconds longest_span = 90 * day;

/// The scanning heads, or the others: only heads of the same sort can replace each other.
std::vector<const LoggedHead*> alike(const std::vector<LoggedHead>& logged, bool scanning) {
  std::vector<const LoggedHead*> found;
  for (const LoggedHead& head : logged) {
    if (head.scanning == scanning) {
      found.push_back(&head);
    }
  }
  return found;
}

// IDs of some devices are unique only on their line; names are unique in a daemon.
const LoggedHead* find_logged(const std::vector<LoggedHead>& logged, const HeadConfig& head, bool only_one) {
  const std::vector<const LoggedHead*> candidates = alike(logged, type_of(head).scanning());
  if (only_one && candidates.size() == 1) {
    return candidates.front();
  }
  const auto named = std::ranges::find(candidates, head.name, &LoggedHead::name);
  const auto found = named != candidates.end()
                         ? named
                         : std::ranges::find(candidates, head.type->device_id(head), &LoggedHead::device_id);
  return found == candidates.end() ? nullptr : *found;
}

// Limits the span, so that even at the slowest speed the last offset is a valid time.
void check_span(const std::vector<PlayedHead>& played, const LogFile& file) {
  std::int64_t first_ns = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
  for (const PlayedHead& head : played) {
    first_ns = std::min(first_ns, head.logged->pings.front().time_ns);
    last_ns = std::max(last_ns, head.logged->pings.back().time_ns);
  }
  const std::chrono::nanoseconds span(last_ns - first_ns);
  if (span > longest_span) {
    throw file.error(
        fmt::format("its times span {} days (expected at most {})", span / day, longest_span / day));
  }
}

/// Adds a head that plays `logged` to the served heads; only logs a warning if `logged` is null.
void cast(const HeadConfig& head, const LoggedHead* logged, const LogFile& file, ReplayConfig& replay) {
  if (logged == nullptr) {
    spdlog::warn("head={}: is not served: {} has no pings of it", head.name, file.path().string());
    return;
  }
  const DeviceType& type = type_of(head);
  if (logged->device_id != type.device_id(head)) {
    spdlog::warn("head={}: replays sonar {} under its own ID {}", head.name, logged->device_id,
                 type.device_id(head));
  }
  if (const std::optional<std::string> reason = type.why_not_played(*logged)) {
    throw file.error(fmt::format("head '{}' cannot play it: {}", head.name, *reason));
  }
  for (const std::string& problem : type.played_wrongly(*logged)) {
    spdlog::warn("head={}: {}", head.name, problem);
  }
  replay.played.push_back({head.name, logged});
  replay.daemon.heads.push_back(type.held_to_recording(head));
}

/// The type that plays a head of a log: its own type, or, if the log does not have it, the first that can.
const DeviceType& player_of(const LoggedHead& logged, const LogFile& file) {
  if (const DeviceType* own = type_of_logged(logged.type, logged.scanning, file.kind())) {
    return *own;
  }
  const auto types = device_types();
  if (!logged.type.empty()) {
    std::vector<std::string_view> names;
    std::ranges::transform(types, std::back_inserter(names), &DeviceType::name);
    throw file.error(
        fmt::format("head {} has the unknown type '{}' (expected {}, or --config with a head to play it)",
                    logged.name.empty() ? std::to_string(logged.device_id) : "'" + logged.name + "'",
                    logged.type, fmt::join(names, " or ")));
  }
  std::optional<std::string> reason;  // of the first type that could have been it
  for (const DeviceType* type : types) {
    if (type->scanning() == logged.scanning) {
      const std::optional<std::string> hindrance = type->why_not_played(logged);
      if (!hindrance) {
        return *type;
      }
      reason = reason.value_or(*hindrance);
    }
  }
  throw file.error(reason.value_or(fmt::format("head {} is of an unknown type", logged.device_id)));
}

}  // namespace

DaemonConfig loopback_config(const std::vector<LoggedHead>& logged, const LogFile& file) {
  DaemonConfig config;
  Ipv4 address = first_loopback_head;
  for (const bool scanning : {false, true}) {
    for (const LoggedHead* head : alike(logged, scanning)) {
      config.heads.push_back(player_of(*head, file).on_loopback(*head, address++));
    }
  }
  return config;
}

ReplayConfig replay_config(DaemonConfig config, const std::vector<LoggedHead>& logged, const LogFile& file) {
  const std::vector<HeadConfig> heads = std::exchange(config.heads, {});
  ReplayConfig replay;
  replay.daemon = std::move(config);
  for (const HeadConfig& head : heads) {
    const bool scanning = type_of(head).scanning();
    const auto number = std::ranges::count_if(
        heads, [scanning](const HeadConfig& other) { return type_of(other).scanning() == scanning; });
    cast(head, find_logged(logged, head, number == 1), file, replay);
  }
  if (replay.daemon.heads.empty()) {
    throw file.error("has no pings for the heads to serve");
  }
  check_span(replay.played, file);
  replay.daemon.poses = {};
  replay.daemon.poses.T_world_vehicle_initial = render::Pose{};
  return replay;
}

}  // namespace sonard::server
