// SPDX-License-Identifier: Apache-2.0
// Reads the options of a survey for a type of device.
#pragma once

#include <optional>
#include <string>

#include <fmt/format.h>
#include <CLI/Error.hpp>

namespace sonard::server {

/// For one type of device. All functions throw CLI::ValidationError.
class OptionsOf {
 public:
  /// @param device as named in messages: "Example 100"
  explicit OptionsOf(std::string device) : device_(std::move(device)) {}

  void refuse(const char* option, bool given) const {
    if (given) {
      throw CLI::ValidationError(option, fmt::format("not an option for {}", device_));
    }
  }

  /// Leaves `setting` unchanged if the user gave no value.
  void take(const char* option, const std::optional<double>& value, double least, double most,
            double& setting) const {
    if (value && !(*value >= least && *value <= most)) {
      throw CLI::ValidationError(
          option, fmt::format("{} is out of range for {} (expected {} to {})", *value, device_, least, most));
    }
    setting = value.value_or(setting);
  }

 private:
  std::string device_;
};

}  // namespace sonard::server
