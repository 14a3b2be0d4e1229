// SPDX-License-Identifier: Apache-2.0
// Parts of a log that cannot be read, and what a reader does when it meets one.
#pragma once

#include <cstdint>

#include "protocol/common/wire_error.hpp"

namespace sonard {

/// Bytes of a log that are no record, although readable records may follow.
struct Damage {
  std::uint64_t offset = 0;  ///< in the file
  std::uint64_t size = 0;    ///< bytes that the reader skipped
  WireError error;           ///< why they cannot be read
};

enum class OnDamage : std::uint8_t {
  stop,  ///< end at the first damaged record: nothing that follows counts as whole
  skip,  ///< search for the next readable record and go on
};

}  // namespace sonard
