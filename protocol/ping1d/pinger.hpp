// SPDX-License-Identifier: Apache-2.0
// The pings of a head, and the measurement of the last one. Source: protocol/ping1d/README.md 3.3, 3.4.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/common/ping_cycle.hpp"
#include "protocol/ping1d/device_config.hpp"
#include "protocol/ping1d/device_counters.hpp"
#include "protocol/ping1d/messages.hpp"
#include "protocol/ping1d/scan.hpp"
#include "protocol/ping1d/tracking.hpp"

namespace sonard::ping1d {

/// The part of a Device that pings.
class Pinger {
 public:
  /// What clients set, or auto mode.
  struct Settings {
    Scan scan;
    bool auto_mode = true;
    bool enabled = true;
    std::uint16_t interval_ms = 0;
  };

  /// Has the settings of a head at boot. `config` and `counters` must outlive the pinger.
  Pinger(const DeviceConfig& config, TimePoint start, DeviceCounters& counters);

  /// The next ping has these settings. The caller changes them within their limits.
  Settings settings;
  /// Restores the state at boot. No ping begins before `silent_until`.
  void reboot(TimePoint silent_until);

  /// Pings are wanted from `now` on, after a time without.
  void want(TimePoint now) { wanted_ = now; }
  void hurry();  ///< a shorter interval holds for the next ping
  void cancel() { cycle_.cancel(); }
  void feed(const std::optional<ReplayedPing>& ping);
  void grant() { cycle_.grant(); }
  void on_image(TimePoint now, const PingImage& image);
  void on_image_failed(TimePoint now, std::uint64_t number) { cycle_.on_image_failed(now, number); }

  /// Sends the ping under way, if it is due. True: there is a new measurement.
  bool send(TimePoint now, std::uint8_t id);
  /// Begins a ping if it is due. Call it only while pings are wanted.
  void begin(TimePoint now);
  /// When the image can be sent; nullopt if there is no image.
  std::optional<TimePoint> send_due() const;
  std::optional<TimePoint> next_start() const;
  /// Sets the members of the actions that concern the ping under way.
  void report(Actions& actions) { cycle_.report(actions); }
  /// The announcement of a ping that starts then.
  NextPing announced(TimePoint start) const { return {start, period(), listening_time(settings.scan)}; }

  /// The newest ping; ping_number 0: none yet.
  const Distance& measured() const { return measured_; }
  const std::vector<std::uint8_t>& profile() const { return profile_; }

 private:
  /// The ping under way.
  struct Ping {
    Scan scan;
    std::chrono::nanoseconds since_last{};
    std::optional<Distance> recorded;
    Echo echo;  ///< set at the arrival of the image
  };

  void boot();
  std::chrono::nanoseconds period() const {
    return ping_period(settings.scan, settings.interval_ms, config_);
  }
  PingJob next_job();
  Distance measurement();

  const DeviceConfig& config_;
  DeviceCounters& counters_;
  PingCycle cycle_;
  Ping ping_;
  Tracking tracking_;
  Distance measured_;
  std::vector<std::uint8_t> profile_;  ///< of that ping
  TimePoint next_ping_{};              ///< by the rate
  TimePoint wanted_{};                 ///< since when pings are wanted
  TimePoint last_start_{};
};

}  // namespace sonard::ping1d
