// SPDX-License-Identifier: Apache-2.0
// What this process holds of the machine. Source: proc(5).
#pragma once

#include <cstddef>

namespace sonard::soak {

struct Footprint {
  std::size_t resident_bytes = 0;
  std::size_t heap_bytes = 0;  ///< handed out by malloc and not given back
  std::size_t threads = 0;
  std::size_t descriptors = 0;
};

/// @throws std::runtime_error where /proc is not there
Footprint footprint();

}  // namespace sonard::soak
