#include "server/devices/micron_head_log.hpp"

#include <numbers>
#include <utility>

#include <spdlog/spdlog.h>

namespace sonard::server {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

// The part of a job that the client chose.
bool same_settings(const micron::MicronJob& a, const micron::MicronJob& b) {
  return a.bins == b.bins && a.bin_length_m == b.bin_length_m && a.gain_db == b.gain_db &&
         a.ad_low_db == b.ad_low_db && a.ad_span_db == b.ad_span_db && a.eight_bit == b.eight_bit &&
         a.transmit == b.transmit;
}

// Ready and scanning take turns at every request of some drivers.
bool same_state(micron::HeadState a, micron::HeadState b) {
  const auto works = [](micron::HeadState state) {
    return state == micron::HeadState::ready || state == micron::HeadState::scanning;
  };
  return a == b || (works(a) && works(b));
}

}  // namespace

void MicronHeadLog::state(micron::HeadState state) {
  if (!state_ || !same_state(*state_, state)) {
    spdlog::info("head={} {}", head_, to_string(state));
  }
  state_ = state;
}

void MicronHeadLog::settings(const micron::MicronJob& job) {
  if (settings_ && same_settings(*settings_, job)) {
    return;
  }
  settings_ = job;
  spdlog::info(
      "head={} pings: range={:.2f}m bins={} of {:.1f}mm gain={:.1f}dB window={:.1f}+{:.1f}dB bits={}{}",
      head_, job.range_m(), job.bins, 1e3 * job.bin_length_m, job.gain_db, job.ad_low_db, job.ad_span_db,
      job.eight_bit ? 8 : 4, job.transmit ? "" : " listening only");
}

void MicronHeadLog::ping(const micron::MicronJob& job, const HeadPing& ping) const {
  const glm::dvec3& p = ping.T_world_sonar.position_m;
  const glm::dvec3 axis = ping.T_world_sonar.orientation * glm::dvec3(1, 0, 0);
  spdlog::debug(
      "head={} ping number={} bearing={:.3f}deg transmit_us={} position_m=[{:.3f}, {:.3f}, {:.3f}] "
      "axis=[{:.4f}, {:.4f}, {:.4f}]",
      head_, job.ping_number, job.bearing_rad / degree, ping.transmit_us, p.x, p.y, p.z, axis.x, axis.y,
      axis.z);
}

void MicronHeadLog::rates(const MicronHeadCounters& total, std::chrono::duration<double> period) {
  const MicronHeadCounters before = std::exchange(reported_, total);
  if (const std::uint64_t sent = total.device.lines_sent - before.device.lines_sent; sent > 0) {
    spdlog::info("head={} lines_per_s={:.1f} render_ms={:.2f}", head_,
                 static_cast<double>(sent) / period.count(), mean_render_ms(before, total));
  }
  log_skipped(head_, total.skipped - before.skipped);
  const auto warn_of = [&](std::uint64_t now, std::uint64_t then, const char* what) {
    if (now > then) {
      spdlog::warn("head={} {} {}", head_, now - then, what);
    }
  };
  warn_of(total.pings_without_pose, before.pings_without_pose,
          "pings not made: no pose, or only a stale one");
  warn_of(total.device.wrong_node, before.device.wrong_node, "commands were for another node");
  warn_of(total.device.bad_frames, before.device.bad_frames, "commands made no sense");
  warn_of(total.device.not_ready, before.device.not_ready, "requests came before any parameters");
  warn_of(total.link.ports.frames_dropped, before.link.ports.frames_dropped,
          "frames were dropped: a client reads too slowly");
  warn_of(total.link.ports.refused, before.link.ports.refused,
          "clients or datagrams were turned away: not in `allow`, too many, or too long");
}

void MicronHeadLog::totals(const MicronHeadCounters& total) const {
  const micron::DeviceCounters& device = total.device;
  spdlog::info(
      "head={} ends: lines_sent={} pings_failed={} pings_cancelled={} pings_without_pose={} commands={} "
      "dropped_bytes={} bad_frames={} cut_frames={} wrong_node={} unknown_type={} requests_beyond_cap={} "
      "boots={}",
      head_, device.lines_sent, device.pings_failed, device.pings_cancelled, total.pings_without_pose,
      device.commands, device.dropped_bytes, device.bad_frames, device.cut_frames, device.wrong_node,
      device.unknown_type, device.requests_beyond_cap, device.boots);
  const SerialPortCounters& ports = total.link.ports;
  spdlog::info(
      "head={} line: connections={} refused={} bytes_in={} bytes_out={} frames_dropped={} frames_unheard={}",
      head_, ports.connections, ports.refused, ports.bytes_in, ports.bytes_out, ports.frames_dropped,
      total.link.frames_unheard);
  log_skipped(head_, total.skipped);
}

}  // namespace sonard::server
