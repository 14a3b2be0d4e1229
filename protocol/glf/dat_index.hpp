// SPDX-License-Identifier: Apache-2.0
// Finds the records of a .dat. Source: protocol/glf/README.md 1.3, 1.7. No state; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/common/damage.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/glf/piecewise_bytes.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::glf {

struct RecordEntry {
  RecordType type = RecordType::image;
  Origin origin;
  std::uint64_t offset = 0;  ///< in the .dat
  std::uint64_t size = 0;

  bool operator==(const RecordEntry&) const = default;
};

struct DatIndex {
  std::vector<RecordEntry> records;  ///< all whole images and statuses, in the order of the file
  std::uint64_t other_records = 0;   ///< records of unknown types, skipped by their length
  std::vector<Damage> damaged;       ///< unreadable parts that records follow; offsets in the .dat
  bool closed = false;               ///< the file ends with a terminator after the last record
  /// End of the last record. To repair an unclosed .dat, cut it to this size and append dat_terminator. Keep
  /// the original if tail_size is larger than a record can be: then the middle of the file is damaged, and
  /// the repair would lose the records after it (OnDamage::stop).
  std::uint64_t whole_size = 0;
  std::uint64_t tail_size = 0;          ///< bytes from whole_size on that are neither record nor terminator
  std::optional<WireError> tail_error;  ///< why these bytes are not a record; offset in the .dat
};

/// Indexes a .dat. Reads only headers; errors in packed pixels appear on decoding. Skips an invalid image by
/// its length if a record or the end follows there. After other unreadable bytes, OnDamage::skip searches for
/// the next image or status.
DatIndex index_dat(const PiecewiseBytes& dat, OnDamage on_damage = OnDamage::stop);

}  // namespace sonard::glf
