// SPDX-License-Identifier: Apache-2.0
// The settings of a head, and its HTTP interface, which reads and sets them. Source:
// protocol/sonar3d15/README.md 5.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/common/ping_job.hpp"
#include "protocol/sonar3d15/device_config.hpp"
#include "protocol/sonar3d15/http.hpp"

namespace sonard::sonar3d15 {

struct Settings {
  bool acoustics = false;
  bool high_frequency = false;
  double least_range_m = 0.0, range_m = 0.0;
  double sound_speed_mps = 0.0;  ///< assumed by the head; 0: automatic
  bool imu_batches = false;
  UdpMode udp_mode = UdpMode::multicast;
  Endpoint unicast;
};

/// Answers requests, and keeps what they set. A state machine without sockets and clocks; not thread-safe.
class Controls {
 public:
  /// A head that starts at this time. `config` must outlive this object.
  Controls(const DeviceConfig& config, TimePoint start);

  /// Never fails: wrong requests have a reply, too, and change nothing. A path of a later release is not
  /// found.
  Reply answer(TimePoint now, const Request& request);

  const Settings& settings() const { return settings_; }
  /// The speed that the head computes ranges with, and reports.
  double sound_speed_mps(TimePoint now) const;
  /// Destination of the images; nullopt: they are not sent.
  std::optional<Endpoint> destination() const;
  /// Time of the head's clock, since 1970.
  std::chrono::nanoseconds utc(TimePoint now) const { return now + config_.utc_offset + clock_shift_; }

 private:
  friend struct Resources;

  const DeviceConfig& config_;
  Settings settings_;
  std::map<std::string_view, std::string> values_;  ///< JSON of each setting as a client set it, by its path
  std::chrono::nanoseconds clock_shift_;            ///< of the head's clock from that of the network
  double former_speed_mps_ = 0.0;                   ///< that holds until speed_since_
  TimePoint speed_since_;
  TimePoint synced_at_;  ///< with a time server
};

}  // namespace sonard::sonar3d15
