// SPDX-License-Identifier: Apache-2.0
// Unreadable parts of a log, and how a reader handles them.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/common/wire_error.hpp"

namespace sonard {

/// Bytes of a log that are not a record. Readable records may follow.
struct Damage {
  std::uint64_t offset = 0;  ///< in the file
  std::uint64_t size = 0;    ///< bytes that the reader skipped
  WireError error;           ///< why they cannot be read
};

/// A part of a file that is made from a damaged one: new bytes, then bytes of the damaged file.
struct RebuiltPart {
  std::vector<std::uint8_t> made{};
  std::uint64_t offset = 0;  ///< in the damaged file
  std::uint64_t size = 0;
};

enum class OnDamage : std::uint8_t {
  stop,  ///< end at the first damaged record and ignore everything after it
  skip,  ///< search for the next readable record and continue
};

}  // namespace sonard
