// SPDX-License-Identifier: Apache-2.0
// Reads the entries of a .glf, which is a ZIP archive. Source: protocol/glf/README.md 1.2, 1.7. Any thread.
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
  bool deflated = false;               ///< false: stored
  std::uint32_t crc = 0;               ///< of the unpacked content
  std::uint32_t size = 0;              ///< of the unpacked content
  std::size_t offset = 0;              ///< of `data` in the archive
  std::span<const std::uint8_t> data;  ///< the content as in the archive
};

/// All entries in the directory at the end of `archive`. Returns an error if there is no directory, if it
/// points to a missing entry, or if an entry is encrypted or compressed with another method than deflate.
Result<std::vector<ZipEntry>, WireError> zip_entries(std::span<const std::uint8_t> archive);

/// The pieces of an uncompressed entry: stored, or deflated in stored blocks. nullopt if it must be unpacked.
std::optional<PiecewiseBytes> stored_pieces(const ZipEntry& entry);

/// The readable part of the first .dat in an archive that is damaged or has no end.
struct DamagedDat {
  PiecewiseBytes pieces;               ///< of an uncompressed entry
  std::vector<std::uint8_t> unpacked;  ///< of a compressed entry, up to the damage
  std::uint64_t unread_size = 0;       ///< bytes of the file after `pieces` in which no block begins
};

/// Finds the .dat by its local header, by the directory, or else by its first block. Skips damaged headers of
/// stored blocks, and bytes that are missing or too many. nullopt if none leads to a .dat.
/// @param archive the whole file
/// @param max_size maximum bytes to unpack
std::optional<DamagedDat> damaged_dat(std::span<const std::uint8_t> archive, std::uint64_t max_size);

/// Unpacks an entry of at most `max_size` bytes and checks its CRC.
Result<std::vector<std::uint8_t>, WireError> unpacked(const ZipEntry& entry, std::uint64_t max_size);

}  // namespace sonard::glf
