#include "server/replay/replay_config.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "protocol/gemini/bearings.hpp"

namespace sonard::server {
namespace {

constexpr Ipv4 first_loopback_head = 0x7F000002;
constexpr Ipv4 loopback_surface = 0x7F000001;
constexpr double bearing_tolerance_rad = 1e-3;
constexpr std::chrono::hours day{24};
constexpr std::chrono::nanoseconds longest_span = 90 * day;

const RecordedHead* find_recorded(const std::vector<RecordedHead>& recorded, const GeminiHeadConfig& head,
                                  bool only_one) {
  if (only_one && recorded.size() == 1) {
    return &recorded.front();
  }
  const auto found = std::ranges::find(recorded, head.device.sonar_id, &RecordedHead::device_id);
  return found == recorded.end() ? nullptr : &*found;
}

double worst_bearing_error_rad(const RecordedHead& head) {
  const std::vector<double> wire = gemini::bearings_rad();
  double worst = 0.0;
  for (std::size_t i = 0; i < std::min(wire.size(), head.bearings_rad.size()); ++i) {
    worst = std::max(worst, std::abs(head.bearings_rad[i] + wire[i]));  // one to port, one to starboard
  }
  return worst;
}

void check_images(const RecordedHead& head, const std::string& name, const LogFile& file) {
  std::size_t inexact = 0;
  for (const RecordedImage& image : head.images) {
    const std::optional<WireForm> form = wire_form(image.settings);
    if (!form) {
      throw file.error(
          fmt::format("sonar {} has an image of {} lines of {} beams, which a Gemini 720i cannot send "
                      "(expected {} beams)",
                      head.device_id, image.settings.lines, image.settings.beams, gemini::beam_count));
    }
    inexact += form->exact ? 0U : 1U;
  }
  if (inexact > 0) {
    spdlog::warn(
        "head={} {} of {} images have lines of a length that a 720i does not have: clients will show wrong "
        "ranges",
        name, inexact, head.images.size());
  }
  if (const double worst_rad = worst_bearing_error_rad(head); worst_rad > bearing_tolerance_rad) {
    spdlog::warn(
        "head={} bearings of the recording are up to {:.1f} degrees from those of a 720i: clients will show "
        "wrong bearings",
        name, worst_rad * 180.0 / std::numbers::pi);
  }
}

// At the slowest speed the last offset is still a time.
void check_span(const std::vector<PlayedHead>& played, const LogFile& file) {
  std::int64_t first_ns = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
  for (const PlayedHead& head : played) {
    first_ns = std::min(first_ns, head.recorded->images.front().time_ns);
    last_ns = std::max(last_ns, head.recorded->images.back().time_ns);
  }
  const std::chrono::nanoseconds span(last_ns - first_ns);
  if (span > longest_span) {
    throw file.error(
        fmt::format("its times span {} days (expected at most {})", span / day, longest_span / day));
  }
}

/// A head that keeps to the times of the recording.
void hold_to_recording(GeminiHeadConfig& head) {
  head.device.plays_back = true;
  head.device.waits_for_permission = false;
  head.device.min_ping_period = std::chrono::milliseconds{1};
  head.device.render_lead = {};
}

}  // namespace

DaemonConfig loopback_config(const std::vector<RecordedHead>& recorded) {
  DaemonConfig config;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    GeminiHeadConfig head;
    head.name = recorded[i].name.empty() ? fmt::format("gemini-{}", recorded[i].device_id) : recorded[i].name;
    const std::uint16_t id = std::max(recorded[i].device_id, gemini::min_sonar_id);
    head.device.sonar_id = id;
    head.device.mac = {
        0x00, 0x12, 0x34, 0x00, static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id & 0xFF)};
    head.device.alternate_address = first_loopback_head + static_cast<Ipv4>(i);
    head.device.netmask = 0xFF000000;
    head.bind_address = head.device.alternate_address;
    head.status = {StatusDestination::Mode::unicast, {loopback_surface}};
    head.allow = {{0x7F000000, 8}};
    config.heads.emplace_back(std::move(head));
  }
  return config;
}

ReplayConfig replay_config(DaemonConfig config, const std::vector<RecordedHead>& recorded,
                           const LogFile& file) {
  const auto geminis = std::ranges::count_if(
      config.heads, [](const AnyHeadConfig& head) { return std::holds_alternative<GeminiHeadConfig>(head); });
  ReplayConfig replay;
  for (AnyHeadConfig& any : std::exchange(config.heads, {})) {
    auto* const head = std::get_if<GeminiHeadConfig>(&any);
    const RecordedHead* const found =
        head == nullptr ? nullptr : find_recorded(recorded, *head, geminis == 1);
    if (found == nullptr) {
      spdlog::warn("head={} is not served: {} has nothing of it", common(any).name, file.path().string());
      continue;
    }
    if (found->device_id != head->device.sonar_id) {
      spdlog::warn("head={} plays sonar {} under its own ID {}", head->name, found->device_id,
                   head->device.sonar_id);
    }
    check_images(*found, head->name, file);
    hold_to_recording(*head);
    replay.played.push_back({head->name, found});
    config.heads.push_back(std::move(any));
  }
  if (config.heads.empty()) {
    throw file.error("has no images of a Gemini that is to be served");
  }
  check_span(replay.played, file);
  config.poses = {};
  config.poses.T_world_vehicle_initial = render::Pose{};
  replay.daemon = std::move(config);
  return replay;
}

}  // namespace sonard::server
