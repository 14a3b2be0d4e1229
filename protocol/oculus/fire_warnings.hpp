// SPDX-License-Identifier: Apache-2.0
// Values of a fire that a head changes (protocol/oculus/README.md 3.2, 3.3, 8).
#pragma once

#include <vector>

#include "protocol/common/once_warnings.hpp"
#include "protocol/oculus/messages.hpp"
#include "protocol/oculus/models.hpp"

namespace sonard::oculus {

bool requests_full_result(const Fire& fire);

/// Warns once about each field of a client's fires whose value the head changes.
class FireWarnings {
 public:
  explicit FireWarnings(const Model& model) : model_(model) {}

  /// @return true if the head changes a value of this fire; the full result does not count
  bool check(const Fire& fire, std::vector<Notice>& notices);

 private:
  const Model& model_;
  OnceWarnings warnings_;
};

}  // namespace sonard::oculus
