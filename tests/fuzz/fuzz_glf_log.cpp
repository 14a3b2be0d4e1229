// SPDX-License-Identifier: Apache-2.0
// Any bytes as a log. Promises: indexed records lie in order inside the .dat, and no byte is lost; a log that
// was cut, and not damaged before the cut, can be closed and then holds the same records; records that decode
// are stable under encode and decode; every error lies inside the file.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/glf/headers.hpp"
#include "protocol/glf/log_view.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace sonard::glf;
using sonard::OnDamage;
using sonard::Result;
using sonard::WireError;
using sonard::fuzz::require;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t max_unpacked_size = 1U << 20;

void check_index(const DatIndex& index) {
  std::uint64_t end = 0;
  for (const RecordEntry& entry : index.records) {
    require(entry.offset >= end, "records lie one behind the other");
    end = entry.offset + entry.size;
  }
  require(end <= index.whole_size, "all records are whole");
  require(!index.closed || index.tail_size == 0, "nothing follows the terminator");
  require(index.tail_error.has_value() == (index.tail_size > 0), "a tail has its reason");
}

// Compares bytes, not values, because NaN does not equal itself.
template <class Record>
void check_decoded(const Result<Record, WireError>& decoded, const RecordEntry& entry,
                   Result<Record, WireError> (*decode)(std::span<const std::uint8_t>)) {
  if (!decoded) {
    require(decoded.error().offset <= entry.offset + entry.size, "an error lies inside the record");
    return;
  }
  const Bytes encoded = encode(*decoded);
  const auto again = decode(encoded);
  require(again.has_value() && encode(*again) == encoded, "encoding loses nothing");
}

/// Cuts a bare .dat after its last whole record and closes it, as after a crash.
void check_recovery(std::span<const std::uint8_t> dat, const DatIndex& index) {
  Bytes closed(dat.begin(), dat.begin() + static_cast<std::ptrdiff_t>(index.whole_size));
  closed.insert(closed.end(), dat_terminator.begin(), dat_terminator.end());
  const auto again = LogView::open(closed);
  require(again.has_value() && again->index().closed, "what is whole can be closed");
  const auto same_place = [](const RecordEntry& a, const RecordEntry& b) {
    return a.offset == b.offset && a.size == b.size && a.type == b.type;
  };
  require(std::ranges::equal(again->index().records, index.records, same_place),
          "and holds the same records");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span file{data, size};
  const auto log = LogView::open(file, max_unpacked_size);
  if (!log) {
    require(log.error().offset <= size, "an error lies inside the file");
    if (const auto left = LogView::open_damaged(file)) {
      check_index(left->index());
    }
    return 0;
  }
  const DatIndex& index = log->index();
  check_index(index);
  for (const RecordEntry& entry : index.records) {
    if (entry.type == RecordType::image) {
      check_decoded(log->image(entry), entry, decode_image);
    } else {
      check_decoded(log->status(entry), entry, decode_status);
    }
  }
  if (size > 0 && data[0] != 'P') {
    require(index.whole_size + index.tail_size + (index.closed ? 2 : 0) == size,
            "every byte is accounted for");
    // A damaged image may take the appended terminator for its own end.
    if (const DatIndex whole = index_dat(PiecewiseBytes{file}, OnDamage::stop); whole.damaged.empty()) {
      check_recovery(file, whole);
    }
  }
  return 0;
}
