// Files whose writer was killed after any byte.
#include <gtest/gtest.h>

#include <algorithm>

#include "protocol/mcap/recovery.hpp"
#include "tests/unit/mcap/files.hpp"

namespace sonard::mcap::testing {
namespace {

Bytes recovered(const Bytes& cut, const Recovery& recovery) {
  Bytes file{cut.begin(), cut.begin() + static_cast<std::ptrdiff_t>(recovery.keep_size)};
  append(file, recovery.end);
  return file;
}

/// Where the chunks of the file end, by going through its summary.
std::vector<std::uint64_t> chunk_ends(const Bytes& file) {
  std::vector<std::uint64_t> ends;
  const auto summary = read_summary(file);
  for (const ChunkIndex& chunk : summary->chunks) {
    ends.push_back(chunk.offset + chunk.length);
  }
  return ends;
}

constexpr std::size_t header_end = 8 + 9 + 12;  // magic and a header that holds "test"

TEST(McapRecovery, every_cut_keeps_every_whole_chunk) {
  const Bytes whole = finished_file();
  const auto ends = chunk_ends(whole);
  const std::vector<std::size_t> messages_by_chunks{0, 2, 5, 7};
  for (std::size_t size = header_end; size < whole.size(); ++size) {
    SCOPED_TRACE(size);
    const Bytes cut{whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)};
    const auto recovery = recover(cut);
    ASSERT_TRUE(recovery);
    const Bytes file = recovered(cut, *recovery);
    const auto reader = Reader::open(file);
    ASSERT_TRUE(reader);
    EXPECT_TRUE(reader->finished());
    EXPECT_EQ(reader->summary(), recovery->summary);
    const auto chunks =
        static_cast<std::size_t>(std::ranges::count_if(ends, [&](std::uint64_t end) { return end <= size; }));
    EXPECT_EQ(all_of(reader->messages()).size(), messages_by_chunks[chunks]);
    EXPECT_EQ(reader->summary().message_count(), messages_by_chunks[chunks]);
    const auto scanned = scan_data_section(file);
    ASSERT_TRUE(scanned && scanned->ended);
    EXPECT_EQ(scanned->summary, reader->summary()) << "message indexes are where the summary says";
  }
}

TEST(McapRecovery, a_cut_behind_the_last_chunk_gives_the_file_that_was_meant) {
  const Bytes whole = finished_file();
  for (std::size_t size = chunk_ends(whole).back(); size < whole.size(); ++size) {
    const Bytes cut{whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)};
    const auto recovery = recover(cut);
    ASSERT_TRUE(recovery);
    EXPECT_EQ(recovered(cut, *recovery), whole) << size;
  }
}

TEST(McapRecovery, says_how_much_is_lost) {
  const Bytes whole = finished_file();
  const auto size = static_cast<std::ptrdiff_t>(chunk_ends(whole)[1] - 1);
  const auto recovery = recover(Bytes{whole.begin(), whole.begin() + size});
  ASSERT_TRUE(recovery);
  EXPECT_EQ(recovery->lost_size, static_cast<std::uint64_t>(size) - recovery->keep_size);
  EXPECT_GT(recovery->lost_size, 0U);
  EXPECT_EQ(recovery->summary.chunks.size(), 1U);
}

TEST(McapRecovery, a_whole_file_stays_as_it_is) {
  const Bytes whole = finished_file();
  const auto recovery = recover(whole);
  ASSERT_TRUE(recovery);
  EXPECT_EQ(recovery->keep_size, whole.size());
  EXPECT_TRUE(recovery->end.empty());
}

TEST(McapRecovery, zeros_where_the_disk_was_not_written_are_cut_off) {
  const Bytes whole = finished_file();
  const auto size = static_cast<std::ptrdiff_t>(chunk_ends(whole)[1]);
  Bytes cut{whole.begin(), whole.begin() + size};
  cut.resize(cut.size() + 4096);
  const auto recovery = recover(cut);
  ASSERT_TRUE(recovery);
  EXPECT_EQ(recovery->summary.message_count(), 5U);
  EXPECT_EQ(recovery->lost_size, 4096U);
}

TEST(McapRecovery, nothing_to_keep_is_an_error) {
  const Bytes whole = finished_file();
  for (std::ptrdiff_t size = 0; size < static_cast<std::ptrdiff_t>(header_end); ++size) {
    EXPECT_FALSE(recover(Bytes{whole.begin(), whole.begin() + size})) << size;
  }
}

}  // namespace
}  // namespace sonard::mcap::testing
