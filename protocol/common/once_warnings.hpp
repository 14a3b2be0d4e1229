// SPDX-License-Identifier: Apache-2.0
// Warnings about values of a client, each only once.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/common/device.hpp"

namespace sonard {

class OnceWarnings {
 public:
  /// Adds a warning to `notices`, unless one with this `subject` was added before.
  /// `subject` is kept by reference: a literal.
  void warn(std::string_view subject, std::string text, std::vector<Notice>& notices) {
    if (said_.insert(subject).second) {
      notices.push_back({Notice::Level::warning, std::move(text)});
    }
  }

 private:
  std::set<std::string_view> said_;
};

}  // namespace sonard
