// SPDX-License-Identifier: Apache-2.0
// Finishing an MCAP file whose writer was killed.
#pragma once

#include <cstdint>

#include "protocol/mcap/summary.hpp"

namespace sonard::mcap {

/// How to make a file whole: truncate it to `keep_size`, append `end`. Until the caller does, nothing
/// changes.
struct Recovery {
  std::uint64_t keep_size = 0;
  Bytes end;                    ///< empty when the file is whole as it is
  std::uint64_t lost_size = 0;  ///< bytes of the data section that go: a record that was being written
  Summary summary;              ///< of the file when it is whole
};

/// Looks at all of `file`. Keeps everything up to the last whole chunk whose CRC is right, or to the last
/// whole record of a chunk that was growing, which is closed; message indexes that are missing behind the
/// last chunk are written again. An error when not even magic and header are whole, for then there is nothing
/// in it to keep, and for a file with chunks compressed in another way, which sonard did not write.
Result<Recovery, WireError> recover(ByteView file);

}  // namespace sonard::mcap
