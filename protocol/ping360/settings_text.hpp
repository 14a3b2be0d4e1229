// SPDX-License-Identifier: Apache-2.0
// What a client has set, in words for the log.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/ping360/limits.hpp"
#include "protocol/ping360/ping_form.hpp"

namespace sonard::ping360 {

/// Of a ping of this form: how far it reaches, how it is sounded and amplified, how the head scans. The angle
/// is left out: it changes from ping to ping.
std::vector<Setting> settings_of(const PingJob& job, const PingForm& form);

/// "0 to 399 gradians, step 1"
std::string scan_text(const AutoTransmit& scan);

/// What in commands is most likely not what the client means. Each is said once.
class SettingsWarnings {
 public:
  void refused(const OutOfRange& field, std::vector<Notice>& notices);
  void taken(const Transducer& command, std::vector<Notice>& notices);

 private:
  std::set<std::string_view> said_;
};

}  // namespace sonard::ping360
