// SPDX-License-Identifier: Apache-2.0
// The settings of one ping, its samples, and its job for the renderer. Source:
// protocol/ping1d/README.md 2.4, 3.4.
#pragma once

#include <chrono>
#include <cstdint>

#include "protocol/common/ping_job.hpp"
#include "protocol/ping1d/device_config.hpp"

namespace sonard::ping1d {

struct Scan {
  std::uint32_t start_mm = 0;
  std::uint32_t length_mm = 5000;
  std::uint8_t gain = 1;                          ///< setting, 0..6
  std::uint32_t speed_of_sound_mmps = 1'500'000;  ///< with which the head converts times

  std::uint32_t end_mm() const { return start_mm + length_mm; }
  double sound_speed_mps() const { return 1e-3 * speed_of_sound_mmps; }
  bool operator==(const Scan&) const = default;
};

/// A scan for which no client has asked: of trial pings, and of a survey without options.
inline constexpr Scan usual_scan{.start_mm = 0, .length_mm = 10'000, .gain = 3};

/// The samples from which the head makes profile and distance: sample k covers [k, k + 1) * step_mm, in the
/// head's own millimetres. A point of the profile has ten of them, or fewer far from a scan's start.
struct Samples {
  int count = 0;
  double step_mm = 0.0;
};
Samples samples_of(const Scan& scan, int points);

/// Factor of a gain setting in dB (2.3).
double gain_db(std::uint8_t setting);
std::uint16_t transmit_duration_us(const Scan& scan, const DeviceConfig& config);
/// Until the echo of the end of the scan arrives, by the head's speed of sound.
std::chrono::nanoseconds listening_time(const Scan& scan);
/// From ping to ping (3.4). The client sets `interval_ms`.
std::chrono::nanoseconds ping_period(const Scan& scan, std::uint16_t interval_ms, const DeviceConfig& config);

/// A ping to render, with 16-bit amplitudes and without its period.
PingJob make_job(const Scan& scan, const DeviceConfig& config);

}  // namespace sonard::ping1d
