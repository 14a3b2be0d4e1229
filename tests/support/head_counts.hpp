// SPDX-License-Identifier: Apache-2.0
// Reads counters of a head in tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/devices/device_type.hpp"
#include "server/devices/head.hpp"
#include "server/devices/head_rendering.hpp"

namespace sonard::test {

inline std::uint64_t count_of(const std::vector<Counter>& counters, const std::string& name) {
  const auto found = std::ranges::find(counters, name, &Counter::name);
  if (found == counters.end()) {
    throw std::out_of_range("no counter " + name);
  }
  return found->value;
}

inline std::uint64_t device_count(server::Head& head, const std::string& name) {
  return count_of(head.connected().device().counts(), name);
}

inline std::uint64_t transport_count(server::Head& head, const std::string& name) {
  return count_of(head.connected().transport().counts(), name);
}

}  // namespace sonard::test
