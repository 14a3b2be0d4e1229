// SPDX-License-Identifier: Apache-2.0
// Files whose writer was killed after any byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "protocol/mcap/recovery.hpp"
#include "tests/unit/protocol/mcap/files.hpp"

namespace sonard::mcap::testing {
namespace {

Bytes recovered(const Bytes& cut, const Recovery& recovery) {
  Bytes file{cut.begin(), cut.begin() + static_cast<std::ptrdiff_t>(recovery.keep_size)};
  append(file, recovery.end);
  return file;
}

/// Offsets of the ends of the file's chunks.
std::vector<std::uint64_t> chunk_ends(const Bytes& file) {
  std::vector<std::uint64_t> ends;
  const auto summary = read_summary(file);
  for (const ChunkIndex& chunk : summary->chunks) {
    ends.push_back(chunk.offset + chunk.length);
  }
  return ends;
}

constexpr std::size_t header_end = 8 + 9 + 12;  // magic and a header that holds "test"

TEST(McapRecovery, EveryCutKeepsEveryWholeChunk) {
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

TEST(McapRecovery, ACutBehindTheLastChunkGivesTheFileThatWasMeant) {
  const Bytes whole = finished_file();
  for (std::size_t size = chunk_ends(whole).back(); size < whole.size(); ++size) {
    const Bytes cut{whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)};
    const auto recovery = recover(cut);
    ASSERT_TRUE(recovery);
    EXPECT_EQ(recovered(cut, *recovery), whole) << size;
  }
}

TEST(McapRecovery, SaysHowMuchIsLost) {
  const Bytes whole = finished_file();
  const auto size = static_cast<std::ptrdiff_t>(chunk_ends(whole)[1] - 1);
  const auto recovery = recover(Bytes{whole.begin(), whole.begin() + size});
  ASSERT_TRUE(recovery);
  EXPECT_EQ(recovery->lost_size, static_cast<std::uint64_t>(size) - recovery->keep_size);
  EXPECT_GT(recovery->lost_size, 0U);
  EXPECT_EQ(recovery->summary.chunks.size(), 1U);
}

/// A file that grows message by message, in chunks of three messages.
struct GrowingFile {
  Writer writer{"test", 100'000};
  std::uint16_t channel =
      writer.add_channel(writer.add_schema("S", "protobuf", bytes_of("d")), "/a", "protobuf");
  Bytes file;
  std::size_t messages = 0;

  Piece next() {
    const std::string data(20 + 7 * messages, static_cast<char>('a' + messages));
    writer.add_message(channel, 10 + messages, 10 + messages, bytes_of(data));
    ++messages;
    if (messages % 3 == 0) {
      writer.end_chunk();
    } else {
      writer.flush();
    }
    return writer.take();
  }
  static void rewrite(Bytes& file, const Piece& piece, std::size_t size) {
    std::copy_n(piece.rewrite.begin(), size,
                file.begin() + static_cast<std::ptrdiff_t>(piece.rewrite_offset));
  }
};

std::size_t messages_after_recovery(const Bytes& file) {
  const auto recovery = recover(file);
  if (!recovery) {
    return 0;
  }
  const Bytes mended = recovered(file, *recovery);
  const auto reader = Reader::open(mended);
  EXPECT_TRUE(reader && reader->finished());
  EXPECT_EQ(reader->summary(), recovery->summary);
  const auto scanned = scan_data_section(mended);
  EXPECT_TRUE(scanned && scanned->ended && !scanned->last_chunk_open);
  EXPECT_EQ(scanned->summary, reader->summary());
  const auto all = all_of(reader->messages());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].log_time_ns, 10 + i);
    EXPECT_EQ(all[i].data, std::string(20 + 7 * i, static_cast<char>('a' + i)));
  }
  EXPECT_EQ(reader->summary().message_count(), all.size());
  return all.size();
}

TEST(McapRecovery, AChunkThatGrowsKeepsEveryMessageWheneverItsWriterIsKilled) {
  GrowingFile growing;
  for (int i = 0; i < 8; ++i) {
    SCOPED_TRACE(i);
    const Piece piece = growing.next();
    const std::size_t before = growing.messages - 1;
    for (std::size_t size = 0; size <= piece.append.size(); ++size) {  // killed while appending
      Bytes file = growing.file;
      file.insert(file.end(), piece.append.begin(), piece.append.begin() + static_cast<std::ptrdiff_t>(size));
      const std::size_t found = messages_after_recovery(file);
      ASSERT_GE(found, before) << size << " of " << piece.append.size();
      ASSERT_LE(found, before + 1);
    }
    append(growing.file, piece.append);
    EXPECT_EQ(messages_after_recovery(growing.file), growing.messages);
    for (std::size_t size = 0; size < piece.rewrite.size(); ++size) {  // killed while overwriting
      Bytes file = growing.file;
      GrowingFile::rewrite(file, piece, size);
      const std::size_t crc = 33;  // the chunk is open until the first byte of its CRC is written
      if (size <= crc || i % 3 != 2) {
        ASSERT_EQ(messages_after_recovery(file), growing.messages) << size;
      }
    }
    GrowingFile::rewrite(growing.file, piece, piece.rewrite.size());
    EXPECT_EQ(messages_after_recovery(growing.file), growing.messages);
  }
}

TEST(McapRecovery, AFileThatGrewIsTheOneThatWasWrittenAtOnce) {
  GrowingFile growing;
  Writer writer{"test", 100'000};
  const auto channel =
      writer.add_channel(writer.add_schema("S", "protobuf", bytes_of("d")), "/a", "protobuf");
  for (std::size_t i = 0; i < 8; ++i) {
    const Piece piece = growing.next();
    append(growing.file, piece.append);
    GrowingFile::rewrite(growing.file, piece, piece.rewrite.size());
    writer.add_message(channel, 10 + i, 10 + i,
                       bytes_of(std::string(20 + 7 * i, static_cast<char>('a' + i))));
    if (i % 3 == 2) {
      writer.end_chunk();
    }
    const auto reader = Reader::open(growing.file);  // also while it grows
    ASSERT_TRUE(reader);
    EXPECT_EQ(all_of(reader->messages()).size(), i + 1);
  }
  growing.writer.finish();
  const Piece last = growing.writer.take();
  append(growing.file, last.append);
  GrowingFile::rewrite(growing.file, last, last.rewrite.size());
  writer.finish();
  EXPECT_EQ(growing.file, writer.take().append);
}

TEST(McapRecovery, AWholeFileStaysAsItIs) {
  const Bytes whole = finished_file();
  const auto recovery = recover(whole);
  ASSERT_TRUE(recovery);
  EXPECT_EQ(recovery->keep_size, whole.size());
  EXPECT_TRUE(recovery->end.empty());
}

TEST(McapRecovery, ZerosWhereTheDiskWasNotWrittenAreCutOff) {
  const Bytes whole = finished_file();
  const auto size = static_cast<std::ptrdiff_t>(chunk_ends(whole)[1]);
  Bytes cut{whole.begin(), whole.begin() + size};
  cut.resize(cut.size() + 4096);
  const auto recovery = recover(cut);
  ASSERT_TRUE(recovery);
  EXPECT_EQ(recovery->summary.message_count(), 5U);
  EXPECT_EQ(recovery->lost_size, 4096U);
}

TEST(McapRecovery, AWholeFileIsRebuiltWithAllItsMessages) {
  const Bytes whole = finished_file();
  const auto rebuilt = rebuild(whole);
  ASSERT_TRUE(rebuilt);
  EXPECT_TRUE(rebuilt->damaged.empty());
  const Bytes file = rebuilt_file(whole, *rebuilt);
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader && reader->finished());
  EXPECT_EQ(all_of(reader->messages()), messages_in_order);
}

/// Rebuilds `damaged` and checks that the new file is whole. @return its messages
std::vector<Said> messages_rebuilt(const Bytes& damaged) {
  const auto rebuilt = rebuild(damaged);
  if (!rebuilt) {
    ADD_FAILURE() << "not rebuilt";
    return {};
  }
  const Bytes file = rebuilt_file(damaged, *rebuilt);
  const auto reader = Reader::open(file);
  EXPECT_TRUE(reader && reader->finished());
  EXPECT_EQ(reader->summary(), rebuilt->summary);
  const auto scanned = scan_data_section(file);
  EXPECT_TRUE(scanned && scanned->ended && !scanned->error && !scanned->last_chunk_open);
  EXPECT_EQ(scanned->summary, rebuilt->summary) << "message indexes are where the summary says";
  MessageCursor cursor = reader->messages();
  auto messages = all_of(cursor);
  EXPECT_EQ(messages.size(), rebuilt->summary.message_count());
  EXPECT_TRUE(!rebuilt->damaged.empty() || messages.size() == 7) << "a loss is listed";
  return messages;
}

// The file has three chunks, of which the first holds the schema and the first channel.
TEST(McapRecovery, ADamagedChunkDoesNotCostTheChunksAfterIt) {
  const Bytes whole = finished_file();
  const auto summary = read_summary(whole);
  const std::vector<std::size_t> messages_of{2, 3, 2};
  const auto end_of_data = static_cast<std::ptrdiff_t>(whole.size() - 20);  // not closed
  for (std::size_t hit = 0; hit < 3; ++hit) {
    const ChunkIndex& chunk = summary->chunks[hit];
    for (std::size_t at = chunk.offset; at < chunk.offset + chunk.length; ++at) {
      SCOPED_TRACE(at);
      Bytes wrong{whole.begin(), whole.begin() + end_of_data};
      wrong[at] ^= 0x40;
      const auto messages = messages_rebuilt(wrong);
      ASSERT_GE(messages.size(), 7 - messages_of[hit]);
      for (const Said& message : messages) {
        EXPECT_THAT(messages_in_order, ::testing::Contains(message));
      }
      Bytes inserted{whole.begin(), whole.begin() + end_of_data};
      inserted.insert(inserted.begin() + static_cast<std::ptrdiff_t>(at), 0x55);
      if (at > chunk.offset) {  // else the byte is before the chunk, which is whole
        ASSERT_EQ(messages_rebuilt(inserted).size(), 7 - messages_of[hit]);
      }
    }
  }
}

TEST(McapRecovery, AnOpenChunkAfterADamagedOneIsClosed) {
  GrowingFile growing;
  for (int i = 0; i < 8; ++i) {
    const Piece piece = growing.next();
    append(growing.file, piece.append);
    GrowingFile::rewrite(growing.file, piece, piece.rewrite.size());
  }
  const auto section = scan_data_section(growing.file);
  ASSERT_TRUE(section && section->last_chunk_open);
  ASSERT_EQ(section->summary.chunks.size(), 3U);
  Bytes damaged = growing.file;
  damaged[section->summary.chunks[1].offset + 80] ^= 1;
  EXPECT_EQ(messages_rebuilt(damaged).size(), 5U) << "of 3, 3 and 2 messages";
}

TEST(McapRecovery, NothingToKeepIsAnError) {
  const Bytes whole = finished_file();
  for (std::ptrdiff_t size = 0; size < static_cast<std::ptrdiff_t>(header_end); ++size) {
    EXPECT_FALSE(recover(Bytes{whole.begin(), whole.begin() + size})) << size;
  }
}

}  // namespace
}  // namespace sonard::mcap::testing
