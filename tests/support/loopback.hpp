// SPDX-License-Identifier: Apache-2.0
// Loopback addresses for tests that need the device's fixed ports.
#pragma once

#include <unistd.h>
#include <cstdint>

#include "server/net/addresses.hpp"

namespace sonard::test {

/// An address of 127.0.0.0/8 that no other process of this test run uses, so that tests can run in parallel
/// and still bind 52900 and 52901. `host` is 1..254.
inline Ipv4 own_loopback_address(std::uint8_t host) {
  const auto pid = static_cast<std::uint32_t>(getpid());
  return 0x7F000000u | (1 + pid % 0xFFFE) << 8 | host;
}

}  // namespace sonard::test
