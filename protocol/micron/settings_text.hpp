// SPDX-License-Identifier: Apache-2.0
// A client's settings as text for the log.
#pragma once

#include <string>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/common/once_warnings.hpp"
#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// Settings of a ping with these parameters for the log: range, gain, and how the head scans.
std::vector<Setting> settings_of(const PingJob& job, const HeadCommand& parameters,
                                 const DeviceConfig& config);
/// Settings of a recorded ping, from the header of its `line` on the wire.
std::vector<Setting> settings_of(const PingJob& job, const HeadData& line);

/// Warns once about each parameter that is probably a mistake of the client.
class SettingsWarnings {
 public:
  explicit SettingsWarnings(const DeviceConfig& config) : config_(config) {}

  /// @return true if the head clamps a value of `parameters`
  bool check(const HeadCommand& parameters, std::vector<Notice>& notices);
  /// @return true if the head clamps this gain byte
  bool check_gain(int gain, std::vector<Notice>& notices);

 private:
  bool check_bins(const HeadCommand& parameters, std::vector<Notice>& notices);

  const DeviceConfig& config_;
  OnceWarnings warnings_;
};

}  // namespace sonard::micron
