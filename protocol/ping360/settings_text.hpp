// SPDX-License-Identifier: Apache-2.0
// A client's settings as text for the log.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/common/once_warnings.hpp"
#include "protocol/ping360/limits.hpp"
#include "protocol/ping360/ping_form.hpp"

namespace sonard::ping360 {

/// Settings of a ping: range, sampling, pulse, gain, scan. Without the angle, which changes with each ping.
std::vector<Setting> settings_of(const PingJob& job, const PingForm& form);

/// "0 to 399 gradians, step 1"
std::string scan_text(const AutoTransmit& scan);

/// Messages about values that are probably mistakes of the client, each only once.
class SettingsWarnings {
 public:
  void refused(const OutOfRange& field, std::vector<Notice>& notices);
  /// `why` is a literal.
  void refused(std::uint16_t message_id, std::string_view why, std::vector<Notice>& notices);
  void taken(const Transducer& command, std::vector<Notice>& notices);

 private:
  OnceWarnings warnings_;
  bool said_angle_400_ = false;
};

}  // namespace sonard::ping360
