// SPDX-License-Identifier: Apache-2.0
// A whole file byte by byte, written out by hand from the MCAP specification (mcap.dev/spec). Python's
// zlib.crc32 gave its three CRCs.
#include <gtest/gtest.h>

#include "tests/unit/protocol/mcap/files.hpp"

namespace sonard::mcap::testing {
namespace {

// clang-format off
const Bytes magic_bytes{0x89, 'M', 'C', 'A', 'P', 0x30, 0x0D, 0x0A};
const Bytes header{0x01, 9, 0, 0, 0, 0, 0, 0, 0,  0, 0, 0, 0,  1, 0, 0, 0, 'w'};
const Bytes schema{0x03, 20, 0, 0, 0, 0, 0, 0, 0,
                   1, 0,  1, 0, 0, 0, 'S',  2, 0, 0, 0, 'p', 'b',  3, 0, 0, 0, 7, 8, 9};
const Bytes channel{0x04, 32, 0, 0, 0, 0, 0, 0, 0,
                    1, 0,  1, 0,  2, 0, 0, 0, '/', 'c',  2, 0, 0, 0, 'p', 'b',
                    12, 0, 0, 0,  2, 0, 0, 0, 'k', 'k',  2, 0, 0, 0, 'v', 'v'};
const Bytes message{0x05, 24, 0, 0, 0, 0, 0, 0, 0,
                    1, 0,  0, 0, 0, 0,  0x2A, 0, 0, 0, 0, 0, 0, 1,  0x29, 0, 0, 0, 0, 0, 0, 1,  0xAB, 0xCD};
// Chunk of schema, channel and message, 103 bytes.
const Bytes chunk_head{0x06, 143, 0, 0, 0, 0, 0, 0, 0,
                       0x2A, 0, 0, 0, 0, 0, 0, 1,  0x2A, 0, 0, 0, 0, 0, 0, 1,  103, 0, 0, 0, 0, 0, 0, 0};
const Bytes chunk_middle{0, 0, 0, 0,  103, 0, 0, 0, 0, 0, 0, 0};
const Bytes message_index{0x07, 22, 0, 0, 0, 0, 0, 0, 0,
                          1, 0,  16, 0, 0, 0,  0x2A, 0, 0, 0, 0, 0, 0, 1,  70, 0, 0, 0, 0, 0, 0, 0};
const Bytes statistics{0x0B, 56, 0, 0, 0, 0, 0, 0, 0,
                       1, 0, 0, 0, 0, 0, 0, 0,  1, 0,  1, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0,  1, 0, 0, 0,
                       0x2A, 0, 0, 0, 0, 0, 0, 1,  0x2A, 0, 0, 0, 0, 0, 0, 1,
                       10, 0, 0, 0,  1, 0,  1, 0, 0, 0, 0, 0, 0, 0};
// The chunk starts at 26 and has 152 bytes, so the message index starts at 178.
const Bytes chunk_index{0x08, 74, 0, 0, 0, 0, 0, 0, 0,
                        0x2A, 0, 0, 0, 0, 0, 0, 1,  0x2A, 0, 0, 0, 0, 0, 0, 1,
                        26, 0, 0, 0, 0, 0, 0, 0,  152, 0, 0, 0, 0, 0, 0, 0,
                        10, 0, 0, 0,  1, 0,  178, 0, 0, 0, 0, 0, 0, 0,
                        31, 0, 0, 0, 0, 0, 0, 0,  0, 0, 0, 0,
                        103, 0, 0, 0, 0, 0, 0, 0,  103, 0, 0, 0, 0, 0, 0, 0};
// Schema and channel are repeated after the message index. DataEnd is at 279 and has 13 bytes: schema at 292,
// channel at 321, statistics at 362, chunk index at 427, summary offsets at 510.
const Bytes offsets{0x0E, 17, 0, 0, 0, 0, 0, 0, 0,  0x03,  0x24, 1, 0, 0, 0, 0, 0, 0,  29, 0, 0, 0, 0, 0, 0, 0,
                    0x0E, 17, 0, 0, 0, 0, 0, 0, 0,  0x04,  0x41, 1, 0, 0, 0, 0, 0, 0,  41, 0, 0, 0, 0, 0, 0, 0,
                    0x0E, 17, 0, 0, 0, 0, 0, 0, 0,  0x0B,  0x6A, 1, 0, 0, 0, 0, 0, 0,  65, 0, 0, 0, 0, 0, 0, 0,
                    0x0E, 17, 0, 0, 0, 0, 0, 0, 0,  0x08,  0xAB, 1, 0, 0, 0, 0, 0, 0,  83, 0, 0, 0, 0, 0, 0, 0};
const Bytes footer{0x02, 20, 0, 0, 0, 0, 0, 0, 0,  0x24, 1, 0, 0, 0, 0, 0, 0,  0xFE, 1, 0, 0, 0, 0, 0, 0};
// clang-format on

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    append(all, part);
  }
  return all;
}

const Bytes chunk_crc{0x70, 0xFE, 0x5F, 0x79};
const Bytes data_crc{0xE9, 0x36, 0xC4, 0x94};
const Bytes summary_crc{0xEF, 0xFF, 0x0F, 0x44};

Bytes by_hand() {
  return joined(
      {magic_bytes, header,      chunk_head,    chunk_crc,  chunk_middle, schema,
       channel,     message,     message_index, schema,     channel,      Bytes{0x0F, 4, 0, 0, 0, 0, 0, 0, 0},
       data_crc,    schema,      channel,       statistics, chunk_index,  offsets,
       footer,      summary_crc, magic_bytes});
}

constexpr std::uint64_t log_time = 0x01000000'0000002A;

TEST(McapBytes, WriterMakesWhatTheSpecificationSays) {
  Writer writer{"w", 1};
  const auto schema_id = writer.add_schema("S", "pb", Bytes{7, 8, 9});
  const auto channel_id = writer.add_channel(schema_id, "/c", "pb", {{"kk", "vv"}});
  writer.add_message(channel_id, log_time, log_time - 1, Bytes{0xAB, 0xCD});
  writer.finish();
  EXPECT_EQ(writer.file_size(), by_hand().size());
  EXPECT_EQ(writer.take().append, by_hand());
}

TEST(McapBytes, ReaderReadsWhatTheSpecificationSays) {
  const Bytes file = by_hand();
  const auto reader = Reader::open(file);
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->finished());
  EXPECT_EQ(reader->summary().message_count(), 1U);
  EXPECT_EQ(reader->summary().start_time_ns(), log_time);
  EXPECT_EQ(reader->summary().channel(1)->topic, "/c");
  EXPECT_EQ(reader->summary().channel(1)->metadata.at("kk"), "vv");
  EXPECT_EQ(reader->summary().schema(1)->data, (Bytes{7, 8, 9}));
  EXPECT_EQ(all_of(reader->messages()), (std::vector<Said>{{1, 0, log_time, "\xAB\xCD"}}));
}

// The check value of CRC32 for "123456789", in one and in two parts.
TEST(McapBytes, Crc32IsThatOfZip) {
  EXPECT_EQ(crc32(bytes_of("123456789")), 0xCBF43926U);
  EXPECT_EQ(crc32(bytes_of("56789"), crc32(bytes_of("1234"))), 0xCBF43926U);
  EXPECT_EQ(crc32(Bytes{}, 0xCBF43926U), 0xCBF43926U);
}

}  // namespace
}  // namespace sonard::mcap::testing
