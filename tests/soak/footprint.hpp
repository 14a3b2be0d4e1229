// SPDX-License-Identifier: Apache-2.0
// Resources of this process. Source: proc(5).
#pragma once

#include <cstddef>

namespace sonard::soak {

struct Footprint {
  std::size_t resident_bytes = 0;
  std::size_t heap_bytes = 0;  ///< allocated by malloc and not freed
  std::size_t threads = 0;
  std::size_t descriptors = 0;
};

/// @throws std::runtime_error if /proc is missing
Footprint footprint();

}  // namespace sonard::soak
