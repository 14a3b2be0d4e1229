// SPDX-License-Identifier: Apache-2.0
// Writes numbers for binary messages of WebSockets.
#pragma once

#include <bit>
#include <cstring>
#include <string>

namespace sonard::server {

/// Appends the number, least significant byte first.
template <class Number>
void append_number(std::string& out, Number number) {
  static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");
  char bytes[sizeof(Number)];
  std::memcpy(bytes, &number, sizeof(Number));
  out.append(bytes, sizeof(Number));
}

}  // namespace sonard::server
