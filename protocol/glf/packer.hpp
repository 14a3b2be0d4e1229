// SPDX-License-Identifier: Apache-2.0
// Packs a closed .dat into a .glf, without ever having more of it in memory than one block.
// Source: docs/logs.md 1.2. Knows no files: it says which bytes stand around those of the .dat.
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
/// Readers count positions in 31 bits; this leaves room for what stands around the .dat.
inline constexpr std::uint64_t max_dat_size = 2'000'000'000;

/// What has to be known of the .dat beforehand; size and CRC can be counted while it is written (Crc32).
struct DatSummary {
  std::uint64_t size = 0;  ///< with its terminator
  std::uint32_t crc = 0;
};

/// Write, in this order: head(); for each block of pack_block_size bytes of the .dat block_header(its size)
/// and the block; tail(). Nothing else, and nothing twice.
class Packer {
 public:
  /// @param stamp what names are made of (log_stamp())
  /// @param config_xml the .cfg, of at most pack_block_size bytes
  /// @param dat what is packed
  /// @param closed when, on the log's clock
  /// @throws std::invalid_argument where .cfg or .dat are too large
  Packer(const std::string& stamp, std::string config_xml, const DatSummary& dat, const CivilTime& closed);

  /// The .cfg with all that belongs to it, and the local header of the .dat.
  std::vector<std::uint8_t> head() const;
  /// @param size of the block that follows, 1..pack_block_size
  static std::array<std::uint8_t, 5> block_header(std::size_t size);
  /// The end of the .dat, the directory and its end.
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
