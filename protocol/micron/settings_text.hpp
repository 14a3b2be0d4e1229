// SPDX-License-Identifier: Apache-2.0
// What a host has set, in words for the log.
#pragma once

#include <string>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// Of a ping with these parameters: how far it reaches, how it is amplified, how the head scans.
std::vector<Setting> settings_of(const PingJob& job, const HeadCommand& parameters,
                                 const DeviceConfig& config);
/// Of a recorded ping, which said `line` when it travelled.
std::vector<Setting> settings_of(const PingJob& job, const HeadData& line);

/// What in such parameters is most likely not what the client means. Each is said once.
class SettingsWarnings {
 public:
  explicit SettingsWarnings(const DeviceConfig& config) : config_(config) {}

  void check(const HeadCommand& parameters, std::vector<Notice>& notices);

 private:
  const DeviceConfig& config_;
  bool said_gain_ = false;
  bool said_limits_ = false;
  bool said_mirrored_ = false;
};

}  // namespace sonard::micron
