// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/pinger.hpp"

#include <algorithm>
#include <utility>

#include "protocol/ping1d/auto_mode.hpp"
#include "protocol/ping1d/recorded_form.hpp"

namespace sonard::ping1d {

Pinger::Pinger(const DeviceConfig& config, TimePoint start, DeviceCounters& counters)
    : config_(config),
      counters_(counters),
      cycle_({.simulated_time = config.simulated_time, .plays_back = config.plays_back}, start, counters),
      tracking_(config.confidence_window) {
  boot();
}

void Pinger::boot() {
  settings = {.scan = {.length_mm = config_.scan_length_mm, .gain = config_.gain_setting},
              .interval_ms = config_.interval_ms};
  tracking_ = Tracking(config_.confidence_window);
  measured_ = {.scan_length_mm = config_.scan_length_mm, .gain_setting = config_.gain_setting};
  profile_.assign(static_cast<std::size_t>(config_.points), 0);
}

void Pinger::reboot(TimePoint silent_until) {
  cycle_.reboot(silent_until);
  boot();
}

void Pinger::hurry() {
  next_ping_ = std::min(next_ping_, last_start_ + period());
}

void Pinger::feed(const std::optional<ReplayedPing>& ping) {
  cycle_.feed(ping && recorded_form(ping->wire) ? ping : std::nullopt);
}

std::optional<TimePoint> Pinger::next_start() const {
  return cycle_.next_start(std::max(wanted_, cycle_.answered_at()), next_ping_);
}

std::optional<TimePoint> Pinger::send_due() const {
  if (!cycle_.rendered()) {
    return std::nullopt;
  }
  return cycle_.job().transmit_time +
         (config_.simulated_time ? std::chrono::nanoseconds{0} : cycle_.job().listening_time);
}

PingJob Pinger::next_job() {
  const std::optional<ReplayedPing>& fed = cycle_.fed();
  if (!fed) {
    return make_job(settings.scan, config_);
  }
  ping_.recorded = recorded_form(fed->wire);
  PingJob job = make_job(*fed, *ping_.recorded);
  if (!settings.auto_mode) {
    job.differences = differences(settings.scan, *ping_.recorded);
  }
  return job;
}

void Pinger::begin(TimePoint now) {
  const std::optional<TimePoint> start = next_start();
  if (!start || now < *start || !cycle_.granted()) {
    return;
  }
  ping_ = {.scan = settings.scan, .since_last = now - last_start_, .recorded = {}, .echo = {}};
  PingJob job = next_job();
  job.period = std::max(period(), job.listening_time);
  last_start_ = now;
  // Keeps the phase; after a late call at most one missed period is caught up.
  next_ping_ = std::max(std::max(next_ping_, now - job.period) + job.period, now + job.listening_time);
  cycle_.begin(std::move(job), now);
}

void Pinger::on_image(TimePoint now, const PingImage& image) {
  if (!cycle_.on_image(now, image.number)) {
    return;
  }
  const std::vector<float> strength = amplitudes(image);
  if (strength.empty() || strength.size() != static_cast<std::size_t>(cycle_.job().bins()) ||
      (ping_.recorded && strength.size() != image.u8.size())) {
    cycle_.fail();
  } else if (ping_.recorded) {
    ping_.echo.profile = image.u8;
  } else {
    ping_.echo = find_echo(strength, ping_.scan, config_.points, 1e3 * config_.least_range_m);
  }
}

Distance Pinger::measurement() {
  if (ping_.recorded) {
    return *ping_.recorded;
  }
  tracking_.add(ping_.echo, ping_.since_last);
  return measured_by(ping_.scan, config_, tracking_.distance_mm(), tracking_.confidence_percent());
}

bool Pinger::send(TimePoint now, std::uint8_t id) {
  const std::optional<TimePoint> due = send_due();
  if (!due || now < *due) {
    return false;
  }
  const std::uint32_t number = measured_.ping_number + 1;
  measured_ = measurement();
  measured_.ping_number = number;
  profile_ = ping_.echo.profile;
  cycle_.put_on_wire(record_of(
      measured_, profile_, ping_.recorded ? cycle_.job().sound_speed_mps : ping_.scan.sound_speed_mps(), id));
  ++counters_.pings_sent;
  if (settings.auto_mode && !ping_.recorded) {
    settings.scan = next_auto_scan(settings.scan, ping_.echo, config_);
  }
  return true;
}

}  // namespace sonard::ping1d
