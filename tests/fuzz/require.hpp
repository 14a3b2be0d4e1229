// SPDX-License-Identifier: Apache-2.0
// How a fuzz program reports a broken promise.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace sonard::fuzz {

/// Aborts the program if `holds` is false; libFuzzer then reports a finding and keeps the input.
inline void require(bool holds, const char* promise) {
  if (!holds) {
    std::fprintf(stderr, "broken promise: %s\n", promise);
    std::abort();
  }
}

}  // namespace sonard::fuzz
