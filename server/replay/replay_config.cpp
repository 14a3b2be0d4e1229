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
constexpr std::uint16_t serial_port = 4001;  // that of serial device servers
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

// Nodes are unique on a line only, names in a daemon.
const RecordedScan* find_recorded(const std::vector<RecordedScan>& recorded, const MicronHeadConfig& head,
                                  bool only_one) {
  if (only_one && recorded.size() == 1) {
    return &recorded.front();
  }
  const auto named = std::ranges::find(recorded, head.name, &RecordedScan::name);
  const auto found = named != recorded.end()
                         ? named
                         : std::ranges::find(recorded, head.device.node, &RecordedScan::device_id);
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

void check(const RecordedHead& head, const std::string& name, const LogFile& file) {
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

void check(const RecordedScan& scan, const std::string& name, const LogFile& file) {
  if (!std::ranges::all_of(scan.lines,
                           [](const RecordedScanLine& line) { return line.wire_line.has_value(); })) {
    throw file.error(
        fmt::format("scan lines of node {}, which head '{}' is to play, do not say how they travelled "
                    "(expected wire_line)",
                    scan.device_id, name));
  }
}

// At the slowest speed the last offset is still a time.
void check_span(const std::vector<PlayedHead>& played, const LogFile& file) {
  std::int64_t first_ns = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
  for (const PlayedHead& head : played) {
    const std::vector<std::int64_t> times_ns = head.times_ns();
    first_ns = std::min(first_ns, times_ns.front());
    last_ns = std::max(last_ns, times_ns.back());
  }
  const std::chrono::nanoseconds span(last_ns - first_ns);
  if (span > longest_span) {
    throw file.error(
        fmt::format("its times span {} days (expected at most {})", span / day, longest_span / day));
  }
}

int id_of(const GeminiHeadConfig& head) {
  return head.device.sonar_id;
}
int id_of(const MicronHeadConfig& head) {
  return head.device.node;
}
const char* kind_of(const RecordedHead&) {
  return "sonar";
}
const char* kind_of(const RecordedScan&) {
  return "node";
}

/// A head that keeps to the times of the recording.
void hold_to_recording(GeminiHeadConfig& head) {
  head.device.plays_back = true;
  head.device.waits_for_permission = false;
  head.device.min_ping_period = std::chrono::milliseconds{1};
  head.device.render_lead = {};
}
void hold_to_recording(MicronHeadConfig& head) {
  head.device.plays_back = true;
  head.device.waits_for_permission = false;
}

std::string name_or(const std::string& name, const char* kind, int id) {
  return name.empty() ? fmt::format("{}-{}", kind, id) : name;
}

GeminiHeadConfig on_loopback(const RecordedHead& recorded, Ipv4 address) {
  GeminiHeadConfig head;
  head.name = name_or(recorded.name, "gemini", recorded.device_id);
  const std::uint16_t id = std::max(recorded.device_id, gemini::min_sonar_id);
  head.device.sonar_id = id;
  head.device.mac = {
      0x00, 0x12, 0x34, 0x00, static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id & 0xFF)};
  head.device.alternate_address = address;
  head.device.netmask = 0xFF000000;
  head.bind_address = address;
  head.status = {StatusDestination::Mode::unicast, {loopback_surface}};
  head.allow = {{0x7F000000, 8}};
  return head;
}

MicronHeadConfig on_loopback(const RecordedScan& recorded, Ipv4 address) {
  MicronHeadConfig head;
  head.name = name_or(recorded.name, "micron", recorded.device_id);
  if (recorded.device_id >= 1 && recorded.device_id < micron::host_node) {
    head.device.node = static_cast<std::uint8_t>(recorded.device_id);
  }
  head.serial.tcp.push_back({{address, serial_port}, {{0x7F000000, 8}}});
  return head;
}

/// Adds a head that plays `recorded`, if that is anything, to the heads that are served.
template <class Config, class Recorded>
void cast(Config head, const Recorded* recorded, const LogFile& file, DaemonConfig& served,
          std::vector<PlayedHead>& played) {
  if (recorded == nullptr) {
    spdlog::warn("head={} is not served: {} has nothing of it", head.name, file.path().string());
    return;
  }
  if (recorded->device_id != id_of(head)) {
    spdlog::warn("head={} plays {} {} under its own ID {}", head.name, kind_of(*recorded),
                 recorded->device_id, id_of(head));
  }
  check(*recorded, head.name, file);
  hold_to_recording(head);
  played.push_back({head.name, recorded});
  served.heads.push_back(std::move(head));
}

}  // namespace

DaemonConfig loopback_config(const std::vector<RecordedHead>& heads, const std::vector<RecordedScan>& scans) {
  DaemonConfig config;
  Ipv4 address = first_loopback_head;
  for (const RecordedHead& head : heads) {
    config.heads.emplace_back(on_loopback(head, address++));
  }
  for (const RecordedScan& scan : scans) {
    config.heads.emplace_back(on_loopback(scan, address++));
  }
  return config;
}

ReplayConfig replay_config(DaemonConfig config, const std::vector<RecordedHead>& heads,
                           const std::vector<RecordedScan>& scans, const LogFile& file) {
  const auto geminis = std::ranges::count_if(
      config.heads, [](const AnyHeadConfig& head) { return std::holds_alternative<GeminiHeadConfig>(head); });
  const auto microns = static_cast<std::ptrdiff_t>(config.heads.size()) - geminis;
  ReplayConfig replay;
  for (const AnyHeadConfig& any : std::exchange(config.heads, {})) {
    if (const auto* const gemini = std::get_if<GeminiHeadConfig>(&any)) {
      cast(*gemini, find_recorded(heads, *gemini, geminis == 1), file, config, replay.played);
    } else {
      const auto& micron = std::get<MicronHeadConfig>(any);
      cast(micron, find_recorded(scans, micron, microns == 1), file, config, replay.played);
    }
  }
  if (config.heads.empty()) {
    throw file.error("has no pings of a head that is to be served");
  }
  check_span(replay.played, file);
  config.poses = {};
  config.poses.T_world_vehicle_initial = render::Pose{};
  replay.daemon = std::move(config);
  return replay;
}

}  // namespace sonard::server
