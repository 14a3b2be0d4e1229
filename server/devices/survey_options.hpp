// SPDX-License-Identifier: Apache-2.0
// How a kind of device takes the options of a survey.
#pragma once

#include <optional>
#include <string>

#include <fmt/format.h>
#include <CLI/Error.hpp>

namespace sonard::server {

/// For one kind of device. @throws CLI::ValidationError from all functions
class OptionsOf {
 public:
  /// @param device as messages name it: "Example 100"
  explicit OptionsOf(std::string device) : device_(std::move(device)) {}

  void refuse(const char* option, bool given) const {
    if (given) {
      throw CLI::ValidationError(option, fmt::format("not an option for {}", device_));
    }
  }

  /// Leaves `setting` as it is where the user says nothing.
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
