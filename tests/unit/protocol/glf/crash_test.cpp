// SPDX-License-Identifier: Apache-2.0
// Logs whose writer stopped at any byte, and the records that can still be read (protocol/glf/README.md 1.7).
#include <algorithm>

#include <gtest/gtest.h>

#include "protocol/glf/headers.hpp"
#include "tests/unit/protocol/glf/fixture.hpp"

namespace sonard::glf::testing {
namespace {

struct SmallLog {
  std::vector<Bytes> parts{encode(patterned_image(1)), encode(small_image()), encode(small_status()),
                           encode(patterned_image(2))};
  /// Offsets of the record boundaries: the start of the first record, then the end of each record.
  std::vector<std::size_t> ends{0};

  SmallLog() {
    for (const Bytes& part : parts) {
      ends.push_back(ends.back() + part.size());
    }
  }
};

TEST(Crash, WholeLogsAreIndexed) {
  const SmallLog log;
  for (const Bytes& file : {small_dat(), packed(small_dat())}) {
    const auto view = LogView::open(file);
    ASSERT_TRUE(view);
    const DatIndex& index = view->index();
    ASSERT_EQ(index.records.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(index.records[i].offset, log.ends[i]);
      EXPECT_EQ(index.records[i].size, log.parts[i].size());
    }
    EXPECT_EQ(index.records[1].origin, (Origin{.time_s = 1000.5, .device_id = 1194, .node_id = 101}));
    EXPECT_EQ(index.records[2].type, RecordType::status);
    EXPECT_TRUE(index.closed);
    EXPECT_EQ(index.whole_size, log.ends.back());
    EXPECT_EQ(index.tail_size, 0U);
    EXPECT_FALSE(index.tail_error);
    EXPECT_EQ(*view->image(index.records[0]), patterned_image(1));
    EXPECT_EQ(*view->image(index.records[1]), small_image());
    EXPECT_EQ(*view->status(index.records[2]), small_status());
    EXPECT_EQ(*view->image(index.records[3]), patterned_image(2));
  }
}

TEST(Crash, EveryCutKeepsTheWholeRecordsAndCanBeClosed) {
  const SmallLog log;
  const Bytes whole = small_dat();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const auto view = LogView::open(cut);
    ASSERT_TRUE(view) << size;
    const auto next = std::ranges::upper_bound(log.ends, size);
    const auto records = static_cast<std::size_t>(next - log.ends.begin()) - 1;
    const DatIndex& index = view->index();
    ASSERT_EQ(index.records.size(), records) << size;
    EXPECT_FALSE(index.closed);
    EXPECT_EQ(index.whole_size, log.ends[records]);
    EXPECT_EQ(index.tail_size, size - log.ends[records]);
    EXPECT_EQ(index.tail_error.has_value(), index.tail_size > 0) << size;

    Bytes closed(cut.begin(), cut.begin() + static_cast<std::ptrdiff_t>(index.whole_size));
    closed.insert(closed.end(), dat_terminator.begin(), dat_terminator.end());
    const auto again = LogView::open(closed);
    ASSERT_TRUE(again);
    EXPECT_TRUE(again->index().closed);
    EXPECT_EQ(again->index().records, index.records);
  }
}

TEST(Crash, TailsSayWhyAndWhere) {
  Bytes dat = small_dat();
  dat.resize(dat.size() - 3);
  const SmallLog log;
  const std::size_t start = log.ends[3];
  EXPECT_EQ(LogView::open(dat)->index().tail_error,
            (WireError{WireErrorReason::truncated, start + 51, "pixels"}));
  dat.resize(start);
  dat.insert(dat.end(), 1000, 0);  // the file system had extended the file, but not written the data
  EXPECT_EQ(LogView::open(dat)->index().tail_error, (WireError{WireErrorReason::bad_value, start, "id"}));
  EXPECT_EQ(LogView::open(dat)->index().tail_size, 1000U);
}

TEST(Crash, ArchivesThatWereCutAreRefused) {
  const Bytes whole = packed(small_dat());
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const auto view = LogView::open(std::span{whole}.first(size));
    ASSERT_FALSE(view) << size;
    EXPECT_EQ(view.error(), (WireError{WireErrorReason::truncated, size, "end_signature"}));
  }
}

TEST(Crash, OfAnArchiveWithoutItsEndEveryWholeRecordIsLeft) {
  const SmallLog log;
  const Bytes whole = packed(small_dat());
  // The records start after both local headers, the .cfg and the first block's header. One block holds them
  // all.
  const auto first = std::search(whole.begin(), whole.end(), log.parts[0].begin(), log.parts[0].end());
  ASSERT_NE(first, whole.end());
  const auto start = static_cast<std::size_t>(first - whole.begin());
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const std::span cut(whole.data(), size);
    ASSERT_FALSE(LogView::open(cut)) << size;
    const auto left = LogView::open_damaged(cut);
    if (size < start) {
      EXPECT_TRUE(!left || left->index().records.empty()) << size;
      continue;
    }
    ASSERT_TRUE(left) << size;
    const auto next = std::ranges::upper_bound(log.ends, size - start);
    ASSERT_EQ(left->index().records.size(), static_cast<std::size_t>(next - log.ends.begin()) - 1) << size;
  }
}

TEST(Crash, OfSeveralBlocksNoneIsLost) {
  std::vector<Bytes> parts;
  for (int i = 0; i < 40; ++i) {
    parts.push_back(encode(patterned_image(i), 0));  // 3.8 kB each, uncompressed: three blocks
  }
  Bytes dat = joined(parts);
  dat.insert(dat.end(), dat_terminator.begin(), dat_terminator.end());
  Bytes archive = packed(dat);
  archive.resize(archive.size() - 30);  // into the end record
  const auto left = LogView::open_damaged(archive);
  ASSERT_TRUE(left);
  ASSERT_EQ(left->index().records.size(), 40U);
  EXPECT_EQ(*left->image(left->index().records[39]), patterned_image(39));
}

}  // namespace
}  // namespace sonard::glf::testing
