#include "server/devices/micron_head_log.hpp"

#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "protocol/micron/scan_settings.hpp"
#include "protocol/micron/sweep.hpp"

namespace sonard::server {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

}  // namespace

void MicronHeadLog::state(TimePoint now, micron::HeadState state) {
  using micron::HeadState;
  if (state != HeadState::ready || said_ != HeadState::scanning) {
    idle_since_.reset();
  } else if (!idle_since_) {
    idle_since_ = now;
  }
  if (said_ == state || (idle_since_ && now - *idle_since_ < idle_after)) {
    return;
  }
  state_changes_.info("head={} {}", head_, to_string(state));
  said_ = state;
}

void MicronHeadLog::settings(const micron::MicronJob& job, const micron::HeadCommand& asked) {
  const std::string text = fmt::format(
      "range={:.2f}m bins={} of {:.1f}mm gain={:.1f}dB window={:.1f}+{:.1f}dB bits={}{}{}", job.range_m(),
      job.bins, 1e3 * job.bin_length_m, job.gain_db, job.ad_low_db, job.ad_span_db, job.eight_bit ? 8 : 4,
      job.transmit ? "" : " listening only", job.record ? "" : scan_text(asked));
  if (!job.record) {
    warn_of_settings(asked);
  }
  if (text != settings_) {
    settings_ = text;
    setting_changes_.info("head={} pings: {}", head_, text);
  }
}

std::string MicronHeadLog::scan_text(const micron::HeadCommand& asked) const {
  namespace bits = micron::control_bits;
  const char* inverted = asked.has(bits::invert) ? "yes" : "no";
  if (asked.has(bits::motor_off)) {
    return fmt::format(" scan=motor_off inverted={}", inverted);
  }
  const micron::Sector sector = micron::sector_of(asked, config_.limits_order);
  if (micron::stares(asked)) {
    return fmt::format(" scan=stares at={:.2f}deg inverted={}", micron::bearing_deg(sector.left), inverted);
  }
  std::string scan = " scan=all_round";
  if (!asked.has(bits::continuous)) {
    scan = sector.width == micron::units_per_turn
               ? " scan=sector_all_round"
               : fmt::format(" scan=sector from={:.2f}deg to={:.2f}deg", micron::bearing_deg(sector.left),
                             micron::bearing_deg(sector.right()));
  }
  return fmt::format("{} step={:.2f}deg direction={} inverted={}", scan,
                     micron::step_unit_deg * (asked.step == 0 ? micron::step_of_zero : asked.step),
                     asked.has(bits::scan_right) ? "right" : "left", inverted);
}

// Each once: a client that sends such parameters sends them again.
void MicronHeadLog::warn_of_settings(const micron::HeadCommand& asked) {
  namespace bits = micron::control_bits;
  if (asked.gain[0] > micron::gain_full_scale && !std::exchange(said_gain_, true)) {
    spdlog::warn("head={} the client's gain byte {} is beyond 210, the most there is: taken as 80 dB", head_,
                 asked.gain[0]);
  }
  const bool told_to = asked.has(bits::stare) || asked.has(bits::motor_off);
  if (micron::stares(asked) && !told_to && !std::exchange(said_limits_, true)) {
    spdlog::warn(
        "head={} the client's sector has equal limits ({}): the head stares there; 0 to 6400 is a whole turn",
        head_, asked.left_limit);
  }
  if (asked.has(bits::invert) != config_.mounted_inverted && !std::exchange(said_mirrored_, true)) {
    spdlog::warn(
        "head={} left and right are swapped: the client says that the head is mounted boot {}, "
        "`device.mounted_inverted` says boot {}",
        head_, asked.has(bits::invert) ? "down" : "up", config_.mounted_inverted ? "down" : "up");
  }
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
  warn_of(total.device.dropped_bytes, before.device.dropped_bytes,
          "bytes from clients were part of no command");
  for (std::size_t i = 0; i < total.link.each.size(); ++i) {
    const SerialPortReport& port = total.link.each[i];
    const std::uint64_t then = i < before.link.each.size() ? before.link.each[i].counters.frames_dropped : 0;
    if (port.counters.frames_dropped > then) {
      spdlog::warn("head={} {}: {} frames were dropped: a client reads too slowly", head_, port.description,
                   port.counters.frames_dropped - then);
    }
  }
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
      "head={} line: connections={} refused={} bytes_in={} bytes_out={} frames_dropped={} frames_lost={} "
      "frames_unheard={}",
      head_, ports.connections, ports.refused, ports.bytes_in, ports.bytes_out, ports.frames_dropped,
      ports.frames_lost, total.link.frames_unheard);
  log_skipped(head_, total.skipped);
}

}  // namespace sonard::server
