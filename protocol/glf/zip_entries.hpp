// SPDX-License-Identifier: Apache-2.0
// What lies in a ZIP archive, as far as a .glf is one. Source: docs/logs.md 1.2, 1.7. Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/glf/piecewise_bytes.hpp"

namespace sonard::glf {

struct ZipEntry {
  std::string_view name;               ///< views the archive, as `data` does
  bool deflated = false;               ///< else as it is
  std::uint32_t crc = 0;               ///< of the content
  std::uint32_t size = 0;              ///< of the content
  std::size_t offset = 0;              ///< of `data` in the archive
  std::span<const std::uint8_t> data;  ///< the content as the archive holds it
};

/// All entries by the directory at the end of `archive`. Refused: an archive without one, or whose directory
/// points to where there is no entry; entries that are encrypted or packed by another method than deflate.
Result<std::vector<ZipEntry>, WireError> zip_entries(std::span<const std::uint8_t> archive);

/// The pieces of an entry that holds its content as it is: stored, or deflated in stored blocks. nullopt for
/// one that has to be unpacked.
std::optional<PiecewiseBytes> stored_pieces(const ZipEntry& entry);

/// What can be read of the first .dat in an archive that is damaged or has no end.
struct DamagedDat {
  PiecewiseBytes pieces;               ///< of an entry that holds its content as it is
  std::vector<std::uint8_t> unpacked;  ///< what came out of a compressed entry before it broke
};

/// Finds the .dat by its local header, or else by the directory. Steps over damaged headers of stored blocks.
/// nullopt when there is neither.
/// @param archive the whole file
/// @param max_size most bytes to unpack
std::optional<DamagedDat> damaged_dat(std::span<const std::uint8_t> archive, std::uint64_t max_size);

/// Unpacks an entry of at most `max_size` bytes and holds it to its CRC.
Result<std::vector<std::uint8_t>, WireError> unpacked(const ZipEntry& entry, std::uint64_t max_size);

}  // namespace sonard::glf
