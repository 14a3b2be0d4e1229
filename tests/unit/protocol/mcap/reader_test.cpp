// SPDX-License-Identifier: Apache-2.0
// Messages of overlapping chunks in order of time, by channel, and by both ways to the summary.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/protocol/mcap/files.hpp"

namespace sonard::mcap::testing {
namespace {

TEST(McapReader, MessagesComeInTheOrderOfTheirTimes) {
  const Bytes file = finished_file();
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  EXPECT_EQ(all_of(reader->messages()), messages_in_order);
}

TEST(McapReader, MessagesOfEqualTimesComeInTheOrderOfTheFile) {
  Writer writer{"test", 100'000};
  const auto channel = writer.add_channel(0, "/x", "json");
  writer.add_message(channel, 50, 50, bytes_of("first"));
  writer.end_chunk();
  writer.add_message(channel, 10, 10, bytes_of("before"));
  writer.add_message(channel, 50, 50, bytes_of("second"));
  writer.finish();
  const Bytes file = writer.take().append;
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  EXPECT_EQ(all_of(reader->messages()),
            (std::vector<Said>{{1, 1, 10, "before"}, {1, 0, 50, "first"}, {1, 2, 50, "second"}}));
}

TEST(McapReader, OnlyTheChannelsThatWereAskedFor) {
  const Bytes file = finished_file();
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  std::vector<Said> of_b;
  std::ranges::copy_if(messages_in_order, std::back_inserter(of_b),
                       [](const Said& m) { return m.channel_id == 2; });
  EXPECT_EQ(all_of(reader->messages({2})), of_b);
  EXPECT_TRUE(all_of(reader->messages({3})).empty());
}

TEST(McapReader, SummarySaysWhatWasWritten) {
  const Bytes file = finished_file();
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  const Summary& summary = reader->summary();
  EXPECT_EQ(summary.schemas.size(), 1U);
  EXPECT_EQ(summary.channels.size(), 2U);
  EXPECT_EQ(summary.channels[0].metadata.at("head"), "bow");
  EXPECT_EQ(summary.chunks.size(), 3U);
  EXPECT_EQ(summary.message_counts, (std::map<std::uint16_t, std::uint64_t>{{1, 3}, {2, 4}}));
  EXPECT_EQ(summary.start_time_ns(), 10U);
  EXPECT_EQ(summary.end_time_ns(), 70U);
}

TEST(McapReader, TheDataSectionSaysTheSameAsTheSummary) {
  const Bytes file = finished_file();
  const auto section = scan_data_section(file);
  const auto summary = read_summary(file);
  ASSERT_TRUE(section && summary);
  EXPECT_TRUE(section->ended);
  EXPECT_EQ(section->summary, *summary);
}

TEST(McapReader, PiecesMakeTheSameFile) {
  Writer writer{"test", 1};
  Bytes pieces = writer.take().append;
  const auto channel = writer.add_channel(0, "/x", "json");
  for (std::uint64_t i = 0; i < 5; ++i) {
    writer.add_message(channel, 10 - i, 10 - i, bytes_of("{}"));  // the clock goes back
    append(pieces, writer.take().append);
    EXPECT_EQ(pieces.size(), writer.file_size());
  }
  writer.finish();
  append(pieces, writer.take().append);
  const auto reader = Reader::open(pieces);
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->finished());
  EXPECT_EQ(reader->summary(), writer.summary());
  EXPECT_EQ(scan_data_section(pieces)->summary, writer.summary());
  EXPECT_EQ(all_of(reader->messages()).size(), 5U);
}

TEST(McapReader, AFileWithoutMessagesIsWhole) {
  Writer writer{"test", 1000};
  writer.finish();
  const Bytes file = writer.take().append;
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->finished());
  EXPECT_EQ(reader->summary().message_count(), 0U);
  EXPECT_TRUE(all_of(reader->messages()).empty());
}

TEST(McapReader, ASummaryWithoutChunkIndexesIsRestoredFromTheData) {
  const Bytes file = finished_file();
  const auto section = scan_data_section(file);
  ASSERT_TRUE(section);
  Summary without_chunks = section->summary;
  without_chunks.chunks.clear();
  Bytes plain{file.begin(), file.begin() + static_cast<std::ptrdiff_t>(section->end)};
  append(plain, make_end(without_chunks, plain.size(), 0));
  ASSERT_EQ(read_summary(plain)->chunks.size(), 0U);
  const auto reader = Reader::open(plain);
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->finished());
  EXPECT_FALSE(reader->lacks_summary());
  EXPECT_EQ(reader->summary(), section->summary);
  EXPECT_EQ(all_of(reader->messages()), messages_in_order);
}

TEST(McapReader, RecordsOfLaterVersionsAreSkipped) {
  Bytes file = finished_file();
  const Bytes foreign{0x8F, 3, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3};
  file.insert(file.begin() + 8 + 9 + 12, foreign.begin(), foreign.end());  // after the header of 21 bytes
  file.resize(file.size() - 8);                                            // so that the summary is not used
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->lacks_summary());
  EXPECT_FALSE(reader->stopped_by());
  EXPECT_TRUE(reader->damaged().empty());
  EXPECT_EQ(all_of(reader->messages()), messages_in_order);
}

}  // namespace
}  // namespace sonard::mcap::testing
