// SPDX-License-Identifier: Apache-2.0
// Where the records of a .dat lie. Source: docs/logs.md 1.3, 1.7. No state; any thread.
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
  std::uint64_t other_records = 0;   ///< of types that this library does not know, skipped by their length
  std::vector<Damage> damaged;  ///< parts that are no record, although records follow; offsets in the .dat
  bool closed = false;          ///< the terminator follows the last record, and nothing follows it
  /// Where the last record ends that was found. Cut a .dat that was not closed to this size, append
  /// dat_terminator, and it is a log again. Keep the original where tail_size is more than one record can
  /// be: then something in the middle is damaged, and what lies behind it would go, too (OnDamage::stop).
  std::uint64_t whole_size = 0;
  std::uint64_t tail_size = 0;          ///< bytes from there on that are neither record nor terminator
  std::optional<WireError> tail_error;  ///< why they are no record; offset in the .dat
};

/// Reads headers only: whether the pixels of an image unpack shows when it is decoded. An image that makes no
/// sense is skipped by its length if that leads to a record or the end. OnDamage::skip searches for the next
/// image or status behind anything else that cannot be read.
DatIndex index_dat(const PiecewiseBytes& dat, OnDamage on_damage = OnDamage::stop);

}  // namespace sonard::glf
