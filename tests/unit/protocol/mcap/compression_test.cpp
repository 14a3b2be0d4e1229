// SPDX-License-Identifier: Apache-2.0
// Chunks are compressed when they are closed: reading them, growing files, and broken chunks.
#include "protocol/mcap/compression.hpp"

#include <gtest/gtest.h>

#include "protocol/mcap/recovery.hpp"
#include "tests/unit/protocol/mcap/files.hpp"

namespace sonard::mcap::testing {
namespace {

std::string text_of(int i) {
  return std::string(400, static_cast<char>('a' + i));
}

/// Applies a piece of the writer to the bytes of a file.
void change(const Piece& piece, Bytes& bytes) {
  FileInMemory file{std::move(bytes)};
  piece.apply_to(file);
  bytes = std::move(file.bytes);
}

/// A file of up to nine messages in chunks of three. The piece is taken after each message, so the open chunk
/// is already in the file when it is closed.
Bytes grown_file(Writer& writer, int messages) {
  Bytes file;
  const auto channel = writer.add_channel(0, "/x", "json");
  for (int i = 0; i < messages; ++i) {
    writer.add_message(channel, static_cast<std::uint64_t>(i), 0, bytes_of(text_of(i)));
    if (i % 3 == 2) {
      writer.end_chunk();
    } else {
      writer.flush();
    }
    change(writer.take(), file);
    EXPECT_EQ(file.size(), writer.file_size());
  }
  return file;
}

void expect_messages(const Reader& reader, int count) {
  const auto all = all_of(reader.messages());
  ASSERT_EQ(all.size(), static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(all[static_cast<std::size_t>(i)].data, text_of(i));
  }
}

TEST(McapCompression, AFileThatGrewHoldsEveryMessageAndIsShorter) {
  Writer writer{"test", 100'000, Compression::zstd};
  Bytes file = grown_file(writer, 9);
  writer.finish();
  change(writer.take(), file);
  EXPECT_LT(file.size(), 2000U);  // 3600 bytes of text
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader && reader->finished());
  expect_messages(*reader, 9);
  for (const ChunkIndex& chunk : reader->summary().chunks) {
    EXPECT_EQ(chunk.compression, "zstd");
    EXPECT_LT(chunk.stored_size, chunk.records_size);
  }
  EXPECT_EQ(scan_data_section(file)->summary, reader->summary());
}

TEST(McapCompression, ChunksThatWereNeverInTheFileAreCompressedToo) {
  Writer writer{"test", 1000, Compression::zstd};
  const auto channel = writer.add_channel(0, "/x", "json");
  for (int i = 0; i < 9; ++i) {
    writer.add_message(channel, static_cast<std::uint64_t>(i), 0, bytes_of(text_of(i)));
  }
  writer.finish();
  const Bytes file = writer.take().append;
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader && reader->finished());
  expect_messages(*reader, 9);
}

TEST(McapCompression, WhatDoesNotGetShorterStaysAsItIs) {
  Writer writer{"test", 100'000, Compression::zstd};
  const auto channel = writer.add_channel(0, "/x", "json");
  Bytes noise;
  for (std::uint32_t i = 0, x = 1; i < 500; ++i) {
    x = x * 1'664'525U + 1'013'904'223U;
    noise.push_back(static_cast<std::uint8_t>(x >> 24U));
  }
  writer.add_message(channel, 1, 1, bytes_of(text_of(0)));
  writer.end_chunk();
  writer.add_message(channel, 0x123456789ABCDEFU, 0xFEDCBA987654321U, noise);
  writer.finish();
  const Bytes file = writer.take().append;
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->summary().chunks.at(0).compression, "zstd");
  EXPECT_EQ(reader->summary().chunks.at(1).compression, "");
  EXPECT_EQ(all_of(reader->messages()).at(1).data, std::string(noise.begin(), noise.end()));
}

TEST(McapCompression, AWriterThatIsKilledBetweenTwoPiecesLosesNothing) {
  for (int messages = 1; messages <= 8; ++messages) {
    Writer writer{"test", 100'000, Compression::zstd};
    Bytes file = grown_file(writer, messages);
    const auto recovery = recover(file);
    ASSERT_TRUE(recovery) << messages;
    file.resize(static_cast<std::size_t>(recovery->keep_size));
    append(file, recovery->end);
    const auto reader = Reader::open(file);
    ASSERT_TRUE(reader && reader->finished()) << messages;
    expect_messages(*reader, messages);
  }
}

// The writer has written the shorter chunk over the open one, but not yet cut off the rest of the open one.
TEST(McapCompression, AWriterThatIsKilledBeforeTheCutLosesNothingOfTheChunk) {
  Writer writer{"test", 100'000, Compression::zstd};
  Bytes file = grown_file(writer, 2);
  writer.add_message(1, 2, 0, bytes_of(text_of(2)));
  writer.flush();
  change(writer.take(), file);
  writer.end_chunk();
  const Piece piece = writer.take();
  ASSERT_TRUE(piece.cut_at);
  std::ranges::copy(piece.rewrite, file.begin() + static_cast<std::ptrdiff_t>(piece.rewrite_offset));
  const auto recovery = recover(file);
  ASSERT_TRUE(recovery);
  file.resize(static_cast<std::size_t>(recovery->keep_size));
  append(file, recovery->end);
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader && reader->finished());
  expect_messages(*reader, 3);
}

TEST(McapCompression, AMessageIsFoundAgainAtItsPlace) {
  Writer writer{"test", 100'000, Compression::zstd};
  Bytes file = grown_file(writer, 6);
  writer.finish();
  change(writer.take(), file);
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  MessageCursor cursor = reader->messages();
  std::vector<MessagePlace> places;
  while (cursor.next()) {
    ASSERT_TRUE(cursor.place());
    places.push_back(*cursor.place());
  }
  for (int i = 5; i >= 0; --i) {
    EXPECT_EQ(reader->data_at(places[static_cast<std::size_t>(i)]), bytes_of(text_of(i)));
  }
  MessagePlace beyond = places[0];
  beyond.size = 100'000;
  EXPECT_FALSE(reader->data_at(beyond));
}

TEST(McapCompression, BrokenFramesAreErrors) {
  const Bytes packed = compress_zstd(bytes_of(text_of(0)));
  EXPECT_EQ(decompress_zstd(packed, 400), bytes_of(text_of(0)));
  EXPECT_FALSE(decompress_zstd(packed, 399));
  EXPECT_FALSE(decompress_zstd(packed, largest_unpacked_chunk + 1));
  EXPECT_FALSE(decompress_zstd(std::span(packed).first(packed.size() - 1), 400));
  EXPECT_FALSE(decompress_zstd({}, 0));
  Bytes broken = packed;
  broken[0] ^= 1;
  EXPECT_FALSE(decompress_zstd(broken, 400));
}

}  // namespace
}  // namespace sonard::mcap::testing
