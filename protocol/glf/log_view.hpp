// SPDX-License-Identifier: Apache-2.0
// Reads a log: a whole .glf or its .dat. Source: protocol/glf/README.md 1.2, 1.3, 1.7.
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

/// Views its bytes, for example a mapped file, which must outlive it. It copies them only if the archive is
/// compressed; archives of this library are not. Any thread may read.
class LogView {
 public:
  static constexpr std::uint64_t default_max_unpacked_size = std::uint64_t{1} << 30;

  /// Opens a log. The first byte decides between .glf and .dat; an empty file is a .dat without records. A
  /// .dat with damaged or cut records is not an error: index() reports them. Offsets of errors count from the
  /// start of the file.
  /// @param file the whole .glf or .dat
  /// @param max_unpacked_size maximum bytes to unpack from a compressed archive
  static Result<LogView, WireError> open(std::span<const std::uint8_t> file,
                                         std::uint64_t max_unpacked_size = default_max_unpacked_size);

  /// Opens the records of a file that open() rejects: an archive without its end, or with a damaged header,
  /// directory or block (damaged_dat()), or a .dat with a wrong first byte. nullopt if there is neither a
  /// .dat entry nor a record.
  static std::optional<LogView> open_damaged(std::span<const std::uint8_t> file,
                                             std::uint64_t max_unpacked_size = default_max_unpacked_size);

  LogView(LogView&&) = default;
  LogView& operator=(LogView&&) = default;

  const DatIndex& index() const { return index_; }
  /// Text of the .cfg; empty if there is no .cfg.
  const std::string& config_xml() const { return config_xml_; }
  /// Bytes of a damaged archive after index() in which no block begins.
  std::uint64_t unread_size() const { return unread_size_; }
  /// Reads the whole .dat; false if the archive contains another checksum for it.
  bool matches_checksum() const;

  /// Decodes a record; offsets of errors are in the .dat.
  /// @param entry one of index().records
  Result<ImageRecord, WireError> image(const RecordEntry& entry) const;
  Result<StatusRecord, WireError> status(const RecordEntry& entry) const;

 private:
  LogView() = default;

  static Result<LogView, WireError> open_archive(std::span<const std::uint8_t> archive,
                                                 std::uint64_t max_unpacked_size);
  std::vector<std::uint8_t> record_bytes(const RecordEntry& entry) const;

  std::vector<std::uint8_t> unpacked_;  ///< viewed by dat_ if the archive was compressed
  PiecewiseBytes dat_;
  DatIndex index_;
  std::uint64_t unread_size_ = 0;
  std::string config_xml_;
  std::optional<std::uint32_t> dat_crc_;  ///< as stated in the archive
};

}  // namespace sonard::glf
