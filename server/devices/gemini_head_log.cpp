#include "server/devices/gemini_head_log.hpp"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/config/addresses.hpp"

namespace sonard::server {
namespace {

constexpr std::size_t most_strangers = 8;

// The part of a job that the client chose.
bool same_settings(const gemini::PingJob& a, const gemini::PingJob& b) {
  return a.native_lines == b.native_lines && a.compression_log2 == b.compression_log2 &&
         a.sixteen_bit == b.sixteen_bit && a.transmit == b.transmit && a.gain_db == b.gain_db &&
         a.sound_speed_mps == b.sound_speed_mps;
}

}  // namespace

void GeminiHeadLog::surface(Ipv4 address) {
  if (address == surface_) {
    return;
  }
  if (address == 0) {
    surface_changes_.info("head={} surface {} lost: no command for the time-out, or reboot", head_,
                          address_text(surface_));
  } else {
    surface_changes_.info("head={} surface {} connected", head_, address_text(address));
  }
  surface_ = address;
}

void GeminiHeadLog::settings(const gemini::PingJob& job) {
  if (settings_ && same_settings(*settings_, job)) {
    return;
  }
  settings_ = job;
  setting_changes_.info(
      "head={} pings: range={:.2f}m lines={} compression=x{} gain={:+.1f}dB sound_speed={:.1f}m/s bits={}{}",
      head_, job.native_lines * job.line_step_m, job.lines(), 1 << job.compression_log2, job.gain_db,
      job.sound_speed_mps, job.sixteen_bit ? 16 : 8, job.transmit ? "" : " listening only");
}

void GeminiHeadLog::ping(const gemini::PingJob& job, std::uint64_t transmit_us,
                         const render::Pose& T_world_sonar) const {
  const glm::dvec3& p = T_world_sonar.position_m;
  const glm::dvec3 axis = T_world_sonar.orientation * glm::dvec3(1, 0, 0);
  spdlog::debug(
      "head={} ping number={} id={} transmit_us={} position_m=[{:.3f}, {:.3f}, {:.3f}] axis=[{:.4f}, {:.4f}, "
      "{:.4f}]",
      head_, job.ping_number, job.ping_number % 256, transmit_us, p.x, p.y, p.z, axis.x, axis.y, axis.z);
}

void GeminiHeadLog::stranger(Ipv4 address) {
  if (strangers_.size() < most_strangers && strangers_.insert(address).second) {
    spdlog::warn("head={} drops what {} sends: the address is not in `allow`", head_, address_text(address));
  }
}

void GeminiHeadLog::rates(const GeminiHeadCounters& total, std::chrono::duration<double> period) {
  const GeminiHeadCounters before = std::exchange(reported_, total);
  const std::uint64_t sent = total.device.pings_sent - before.device.pings_sent;
  if (sent > 0) {
    spdlog::info("head={} pings_per_s={:.1f} render_ms={:.1f} lines_resent={} tails_resent={}", head_,
                 static_cast<double>(sent) / period.count(), mean_render_ms(before, total),
                 total.device.lines_resent - before.device.lines_resent,
                 total.device.tails_resent - before.device.tails_resent);
  }
  log_skipped(head_, total.skipped - before.skipped);
  if (const std::uint64_t missed = total.pings_without_pose - before.pings_without_pose; missed > 0) {
    spdlog::warn("head={} {} pings not made: no pose, or only a stale one", head_, missed);
  }
  if (const std::uint64_t suppressed = total.device.pings_suppressed - before.device.pings_suppressed;
      suppressed > 0) {
    spdlog::warn("head={} {} pings not made: out of the water", head_, suppressed);
  }
  if (const std::uint64_t wrong = total.device.wrong_id - before.device.wrong_id; wrong > 0) {
    spdlog::warn("head={} {} commands were for another sonar ID", head_, wrong);
  }
  if (const std::uint64_t unsupported = total.device.unsupported_data - before.device.unsupported_data;
      unsupported > 0) {
    spdlog::warn(
        "head={} {} ping configurations asked for data that is not made here (I/Q, channels) or for run mode "
        "3",
        head_, unsupported);
  }
  if (const std::uint64_t bad = total.device.bad_datagrams - before.device.bad_datagrams; bad > 0) {
    spdlog::warn("head={} {} datagrams were no commands of a Gemini 720i", head_, bad);
  }
}

void GeminiHeadLog::totals(const GeminiHeadCounters& total) const {
  const gemini::DeviceCounters& device = total.device;
  spdlog::info(
      "head={} ends: pings_sent={} render_ms={:.1f} pings_failed={} pings_without_pose={} "
      "pings_suppressed={} lines_sent={} "
      "lines_resent={} tails_resent={} heads_resent={} retries_dropped={} commands={} wrong_id={} "
      "bad_datagrams={} "
      "unknown_type={} unsupported_data={} surface_changes={} surface_timeouts={} reboots={}",
      head_, device.pings_sent, mean_render_ms({}, total), device.pings_failed, total.pings_without_pose,
      device.pings_suppressed, device.lines_sent, device.lines_resent, device.tails_resent,
      device.heads_resent, device.retries_dropped, device.commands, device.wrong_id, device.bad_datagrams,
      device.unknown_type, device.unsupported_data, device.surface_changes, device.surface_timeouts,
      device.reboots);
  const UdpEndpointCounters& socket = total.socket;
  spdlog::info(
      "head={} socket: sent={} received={} not_allowed={} truncated={} kernel_dropped={} blocked={} "
      "send_failed={} "
      "overflowed={}",
      head_, socket.sent, socket.received, total.not_allowed, socket.truncated, socket.kernel_dropped,
      socket.blocked, socket.send_failed, socket.overflowed);
  log_skipped(head_, total.skipped);
  log_faults("to_surface", total.to_surface);
  log_faults("from_surface", total.from_surface);
}

void GeminiHeadLog::log_faults(const char* direction, const FaultyLinkCounters& link) const {
  if (link.lost + link.duplicated + link.reordered > 0) {
    spdlog::info("head={} link {}: passed={} lost={} duplicated={} reordered={}", head_, direction,
                 link.passed, link.lost, link.duplicated, link.reordered);
  }
}

}  // namespace sonard::server
