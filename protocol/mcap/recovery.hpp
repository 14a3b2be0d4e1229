// SPDX-License-Identifier: Apache-2.0
// Repairs an MCAP file whose writer was killed, or which is damaged.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/common/damage.hpp"
#include "protocol/mcap/data_section.hpp"

namespace sonard::mcap {

/// How to make a file whole: truncate it to `keep_size`, append `end`. The caller must do this.
struct Recovery {
  std::uint64_t keep_size = 0;
  Bytes end;                    ///< empty if the file is whole already
  std::uint64_t lost_size = 0;  ///< bytes of the data section that are lost: an incomplete record
  Summary summary;              ///< of the repaired file
};

/// Scans `file` and keeps everything up to the last whole chunk with a correct CRC, or up to the last whole
/// record of an open chunk, which it closes. Restores missing message indexes after the last chunk. Returns
/// an error if magic and header are not whole, because then there is nothing to keep. Also returns an error
/// for other compressions, because sonard did not write such a file.
Result<Recovery, WireError> recover(ByteView file);

/// A file made from all whole chunks of a damaged file. They are not copied into memory.
struct Rebuilt {
  std::vector<RebuiltPart> parts;     ///< the new file is all parts, one after the other
  std::vector<DamagedChunk> damaged;  ///< the lost bytes; there may be none
  Summary summary;                    ///< of the new file
};

/// Rebuilds `file` from its readable chunks, also those after damaged bytes: adds a header, all schemas and
/// channels, message indexes and the end. Returns an error if the file does not begin as MCAP and has no
/// chunk.
Result<Rebuilt, WireError> rebuild(ByteView file);

}  // namespace sonard::mcap
