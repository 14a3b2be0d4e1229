// SPDX-License-Identifier: Apache-2.0
// Files with one damaged byte at a known place, and files with random damage.
#include <gtest/gtest.h>

#include <random>

#include "protocol/mcap/recovery.hpp"
#include "tests/unit/protocol/mcap/files.hpp"

namespace sonard::mcap::testing {
namespace {

constexpr std::size_t first_chunk = 8 + 9 + 12;  // after the magic and a header that holds "test"

TEST(McapBroken, AWrongByteInAChunkCostsItsMessagesAndNamesItsCrc) {
  Bytes file = finished_file();
  file[first_chunk + 9 + 40 + 20] ^= 1;  // inside the records
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  MessageCursor cursor = reader->messages();
  std::size_t messages = 0;
  for (; cursor.next(); ++messages) {
  }
  EXPECT_EQ(messages, 5U) << "two of seven are in the first chunk";
  ASSERT_EQ(cursor.damaged().size(), 1U);
  const DamagedChunk& damaged = cursor.damaged()[0];
  EXPECT_EQ(damaged.error.field, "chunk.uncompressed_crc");
  EXPECT_EQ(damaged.error.offset, first_chunk + 9 + 24);
  EXPECT_EQ(damaged.offset, first_chunk);
  EXPECT_EQ(damaged.lost_messages, (std::map<std::uint16_t, std::uint64_t>{{1, 2}}));
}

TEST(McapBroken, WithoutASummaryChunksBehindADamagedOneAreFound) {
  const Bytes whole = finished_file();
  const std::uint64_t second_chunk = read_summary(whole)->chunks[1].offset;
  Bytes file{whole.begin(), whole.end() - 1};
  for (std::size_t i = 1; i <= 8; ++i) {
    file[first_chunk + i] = 0xFF;  // the length of the first chunk
  }
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  ASSERT_FALSE(reader->damaged().empty());
  EXPECT_EQ(reader->damaged().front().offset, first_chunk);
  EXPECT_LE(reader->damaged().back().offset + reader->damaged().back().size, second_chunk);
  EXPECT_EQ(all_of(reader->messages()).size(), 5U);
}

TEST(McapBroken, ACompressedChunkIsRefusedAndNeverCutOff) {
  Bytes file = finished_file();
  file.resize(file.size() - 1);
  const Bytes name{2, 0, 0, 0, 'z', 's'};
  const std::size_t compression = first_chunk + 9 + 28;
  file.erase(file.begin() + compression, file.begin() + compression + 4);
  file.insert(file.begin() + compression, name.begin(), name.end());
  file[first_chunk + 1] = static_cast<std::uint8_t>(file[first_chunk + 1] + 2);  // the length of the chunk
  const auto recovery = recover(file);
  ASSERT_FALSE(recovery);
  EXPECT_EQ(recovery.error().field, "chunk.compression");
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->damaged().size(), 1U);
  EXPECT_EQ(reader->damaged()[0].error.field, "chunk.compression");
  EXPECT_EQ(all_of(reader->messages()).size(), 5U);
}

// The first chunk would be inside the header, and lost, but a later reader of the repaired file would find
// it.
TEST(McapBroken, AHeaderWithAWrongLengthIsDamagedAndNotKept) {
  const Bytes whole = finished_file();
  Bytes file{whole.begin(), whole.end() - 1};
  file[magic.size() + 1] =
      static_cast<std::uint8_t>(read_summary(whole)->chunks[1].offset - first_chunk + 12);
  const auto recovery = recover(file);
  ASSERT_FALSE(recovery);
  EXPECT_EQ(recovery.error().field, "header");
  const auto rebuilt = rebuild(file);
  ASSERT_TRUE(rebuilt);
  EXPECT_EQ(rebuilt->summary.message_count(), 7U);
}

TEST(McapBroken, SizesBeyondTheFileAreNoWholeRecord) {
  Bytes file = finished_file();
  file.resize(file.size() - 1);
  for (std::size_t i = 1; i <= 8; ++i) {
    file[first_chunk + i] = 0xFF;
  }
  const auto section = scan_data_section(file);
  ASSERT_TRUE(section);
  EXPECT_EQ(section->end, first_chunk);
  EXPECT_TRUE(section->summary.chunks.empty());
}

TEST(McapBroken, ASummaryWithAWrongByteIsNotUsed) {
  Bytes file = finished_file();
  const auto summary_start = scan_data_section(file)->end + 13;
  file[summary_start + 9] ^= 1;
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->finished());
  EXPECT_TRUE(reader->lacks_summary());
  EXPECT_EQ(all_of(reader->messages()), messages_in_order);
}

TEST(McapBroken, ASummaryWhoseChunksOverlapIsNotUsed) {
  const Bytes file = finished_file();
  const auto section = scan_data_section(file);
  ASSERT_TRUE(section);
  Summary twice = section->summary;
  twice.chunks.push_back(twice.chunks.back());
  Bytes hostile{file.begin(), file.begin() + static_cast<std::ptrdiff_t>(section->end)};
  append(hostile, make_end(twice, hostile.size(), 0));
  const auto reader = Reader::open(hostile);
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->lacks_summary());
  EXPECT_EQ(all_of(reader->messages()), messages_in_order);
}

/// A file whose last chunk is open.
Bytes growing_file() {
  Writer writer{"test", 100};
  const auto channel =
      writer.add_channel(writer.add_schema("S", "protobuf", bytes_of("d")), "/a", "protobuf");
  for (std::uint64_t i = 0; i < 7; ++i) {
    writer.add_message(channel, i, i, bytes_of("some bytes"));
  }
  writer.flush();
  return writer.take().append;
}

void flip_bits(const Bytes& whole) {
  std::mt19937 random{1};
  for (int i = 0; i < 20'000; ++i) {
    Bytes file = whole;
    for (unsigned flips = 1 + random() % 4; flips > 0; --flips) {
      file[random() % file.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    }
    if (const auto reader = Reader::open(file)) {
      MessageCursor cursor = reader->messages();
      while (const auto message = cursor.next()) {
        ASSERT_LE(message->data.size(), file.size());
      }
    }
    if (const auto rebuilt = rebuild(file)) {
      const Bytes whole_again = rebuilt_file(file, *rebuilt);
      const auto reader = Reader::open(whole_again);
      ASSERT_TRUE(reader && reader->finished());
      ASSERT_EQ(all_of(reader->messages()).size(), rebuilt->summary.message_count());
    }
    if (const auto recovery = recover(file)) {
      ASSERT_LE(recovery->keep_size, file.size());
    } else {
      ASSERT_LE(recovery.error().offset, file.size());
    }
  }
}

// Every error and every message must lie inside the file. The sanitizers check the rest.
TEST(McapBroken, FlippedBitsNeverCrash) {
  flip_bits(finished_file());
  flip_bits(growing_file());
}

}  // namespace
}  // namespace sonard::mcap::testing
