// SPDX-License-Identifier: Apache-2.0
// Packs a closed .dat into a .glf with at most one block in memory. Source: protocol/glf/README.md 1.2. It
// uses no files: it returns the bytes to write around the blocks of the .dat.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/glf/log_time.hpp"

namespace sonard::glf {

/// Bytes of the .dat in one block; the last block may hold fewer.
inline constexpr std::size_t pack_block_size = 65531;
/// Readers use positions of 31 bits; this leaves room for the bytes around the .dat.
inline constexpr std::uint64_t max_dat_size = 2'000'000'000;

/// Size and checksum of the .dat, which are needed first; count them while writing the .dat (Crc32).
struct DatSummary {
  std::uint64_t size = 0;  ///< with its terminator
  std::uint32_t crc = 0;
};

/// Write exactly, in this order: head(); for each block of pack_block_size bytes of the .dat block_header(its
/// size) and the block; tail().
class Packer {
 public:
  /// @param stamp stamp of the file names (log_stamp())
  /// @param config_xml the .cfg, 1..pack_block_size bytes
  /// @param dat size and checksum of the .dat
  /// @param closed closing time, on the log's clock
  /// @throws std::invalid_argument if the .cfg is empty, or the .cfg or the .dat is too large
  Packer(const std::string& stamp, std::string config_xml, const DatSummary& dat, const CivilTime& closed);

  /// The complete .cfg entry, and the local header of the .dat.
  std::vector<std::uint8_t> head() const;
  /// @param size size of the block that follows, 1..pack_block_size
  static std::array<std::uint8_t, 5> block_header(std::size_t size);
  /// The end of the .dat entry, the directory and the end record.
  std::vector<std::uint8_t> tail() const;

 private:
  struct File {
    std::string name;
    std::uint32_t size = 0;
    std::uint32_t crc = 0;
    std::uint32_t local_offset = 0;
  };

  std::string config_xml_;
  CivilTime closed_;
  std::array<File, 2> files_;  ///< .cfg and .dat
};

}  // namespace sonard::glf
