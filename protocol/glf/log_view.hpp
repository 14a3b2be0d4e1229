// SPDX-License-Identifier: Apache-2.0
// A log that was read: a whole .glf, or the .dat of one. Source: docs/logs.md 1.2, 1.3, 1.7.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/glf/codec.hpp"
#include "protocol/glf/dat_index.hpp"
#include "protocol/glf/piecewise_bytes.hpp"

namespace sonard::glf {

/// Views the bytes it was opened on, which must outlive it; a mapped file will do. They are copied only where
/// an archive is really compressed, which none is that this library packs. Any thread may read.
class LogView {
 public:
  static constexpr std::uint64_t default_max_unpacked_size = std::uint64_t{1} << 30;

  /// What a file is shows by its first bytes. An empty one is a .dat without records. A .dat with damaged
  /// records, or that ends in the middle of one, is no error: index() says so. Offsets of errors count from
  /// the start of the file.
  /// @param file the whole of it, a .glf or a .dat
  /// @param max_unpacked_size most bytes to unpack, of an archive that is compressed
  static Result<LogView, WireError> open(std::span<const std::uint8_t> file,
                                         std::uint64_t max_unpacked_size = default_max_unpacked_size);

  /// The records of a file that open() refuses: an archive without its end, with a damaged header, directory
  /// or block (damaged_dat()), or a .dat whose first byte is wrong. nullopt when there are none.
  static std::optional<LogView> open_damaged(std::span<const std::uint8_t> file,
                                             std::uint64_t max_unpacked_size = default_max_unpacked_size);

  LogView(LogView&&) = default;
  LogView& operator=(LogView&&) = default;

  const DatIndex& index() const { return index_; }
  /// Text of the .cfg; empty without one.
  const std::string& config_xml() const { return config_xml_; }
  /// Reads the whole .dat. True unless the archive states another checksum for it.
  bool matches_checksum() const;

  /// @param entry one of index().records; offsets of errors are in the .dat
  Result<ImageRecord, WireError> image(const RecordEntry& entry) const;
  Result<StatusRecord, WireError> status(const RecordEntry& entry) const;

 private:
  LogView() = default;

  static Result<LogView, WireError> open_archive(std::span<const std::uint8_t> archive,
                                                 std::uint64_t max_unpacked_size);
  std::vector<std::uint8_t> record_bytes(const RecordEntry& entry) const;

  std::vector<std::uint8_t> unpacked_;  ///< what dat_ views where the archive was compressed
  PiecewiseBytes dat_;
  DatIndex index_;
  std::string config_xml_;
  std::optional<std::uint32_t> dat_crc_;  ///< as the archive states it
};

}  // namespace sonard::glf
