// SPDX-License-Identifier: Apache-2.0
// Logs of other programs, damaged logs and malicious logs.
#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "protocol/glf/deflate.hpp"
#include "tests/unit/protocol/glf/fixture.hpp"

namespace sonard::glf::testing {
namespace {

/// A record of a type that only other programs write.
Bytes other_record(std::uint8_t type, std::uint32_t length) {
  Bytes record = encode(small_status());
  record.resize(length);
  patch(record, 2, length);
  record[14] = type;
  return record;
}

TEST(Hostile, OtherTypesAreSkippedByTheirLengthAndCounted) {
  const Bytes dat = joined({encode(small_image()),
                            other_record(1, 21),
                            other_record(99, 180),
                            encode(small_status()),
                            {0xDE, 0xDE}});
  const auto view = LogView::open(dat);
  EXPECT_EQ(view->index().records.size(), 2U);
  EXPECT_EQ(view->index().other_records, 2U);
  EXPECT_TRUE(view->index().closed);
  EXPECT_EQ(*view->status(view->index().records[1]), small_status());
}

TEST(Hostile, OtherTypesOfImpossibleLengthCostThemselves) {
  Bytes other = other_record(99, 40);
  for (const std::uint32_t length : {0U, 20U}) {
    patch(other, 2, length);
    const Bytes dat = joined({encode(small_image()), other, encode(small_status())});
    const DatIndex index = LogView::open(dat)->index();
    EXPECT_EQ(index.records.size(), 2U);
    ASSERT_EQ(index.damaged.size(), 1U);
    EXPECT_EQ(index.damaged[0].offset, 115U);
    EXPECT_EQ(index.damaged[0].size, 40U);
    EXPECT_EQ(index.damaged[0].error, (WireError{WireErrorReason::bad_length, 115 + 2, "length"}));
    EXPECT_EQ(index_dat(PiecewiseBytes{dat}).tail_error, index.damaged[0].error) << "OnDamage::stop";
  }
  patch(other, 2, 0xFFFFFFFFU);
  EXPECT_EQ(LogView::open(joined({encode(small_image()), other}))->index().tail_error,
            (WireError{WireErrorReason::truncated, 115 + 21, "body"}));
}

// Real images are reported to carry 168 there.
TEST(Hostile, WrongLengthsOfImagesDoNotMatter) {
  Bytes image = encode(patterned_image(1));
  patch<std::uint32_t>(image, 2, 168);
  const Bytes dat = joined({image, image, {0xDE, 0xDE}});
  EXPECT_EQ(LogView::open(dat)->index().records.size(), 2U);
}

TEST(Hostile, DamagedImagesDoNotHideWhatComesAfterThem) {
  for (const std::size_t offset : {23U, 31U, 41U, 47U, 112U, 113U}) {
    Bytes image = encode(small_image());
    image[offset] ^= 0x80U;
    const Bytes dat = joined({encode(small_status()), image, encode(small_image()), {0xDE, 0xDE}});
    const auto view = LogView::open(dat);
    ASSERT_TRUE(view);
    const DatIndex& index = view->index();
    // The index does not detect more raw lines than pixels; decoding the image does.
    const bool found_later = offset == 31;
    EXPECT_EQ(index.records.size(), found_later ? 3U : 2U) << offset;
    EXPECT_EQ(index.damaged.size(), found_later ? 0U : 1U) << offset;
    EXPECT_TRUE(index.closed);
    EXPECT_EQ(*view->image(index.records.back()), small_image());
    if (found_later) {
      EXPECT_EQ(view->image(index.records[1]).error(),
                (WireError{WireErrorReason::bad_length, 239 + 51, "pixels"}));
    }
  }
}

// If the length leads to bytes that only look like a header, the next whole record counts as the next one.
TEST(Hostile, DamagedImagesWhoseLengthLeadsNowhereDoNotHideWhatComesAfterThem) {
  constexpr std::size_t next = 60;  // inside the bearings
  Bytes image = encode(small_image());
  patch<std::uint16_t>(image, 23, 0xEFEE);
  patch<std::uint32_t>(image, 2, next);
  std::fill_n(image.begin() + next, 21, std::uint8_t{0});
  const auto ends_there = [&] {
    const Bytes dat = joined({image, encode(small_status()), {0xDE, 0xDE}});
    const DatIndex index = LogView::open(dat)->index();
    EXPECT_EQ(index.records.size(), 1U);
    EXPECT_EQ(index.damaged.size(), 1U);
    EXPECT_EQ(index.damaged.at(0).size, image.size());
    const DatIndex front = index_dat(PiecewiseBytes{dat});
    EXPECT_EQ(front.whole_size, 0U) << "OnDamage::stop";
    EXPECT_EQ(front.tail_error, index.damaged.at(0).error);
    return index.damaged.at(0).error == WireError{WireErrorReason::bad_value, 23, "record_tag"};
  };
  EXPECT_TRUE(ends_there()) << "no header";
  image[next] = '*';
  image[next + 2] = 20;
  EXPECT_TRUE(ends_there()) << "a length of less than the header";
  image[next + 2] = 21;
  image[next + 19] = 1;
  EXPECT_TRUE(ends_there()) << "spare bytes that are not zero";
  image[next + 19] = 0;
  image[next + 20] = 1;
  EXPECT_TRUE(ends_there()) << "nor the second";
}

TEST(Hostile, WhatIsNoLogIsRefused) {
  EXPECT_EQ(LogView::open(from_hex("89 50 4E 47")).error(),
            (WireError{WireErrorReason::bad_value, 0, "file"}));
  EXPECT_EQ(LogView::open(from_hex("50 4B 03 04")).error(),
            (WireError{WireErrorReason::truncated, 4, "end_signature"}));
  EXPECT_TRUE(LogView::open({})->index().records.empty());
}

TEST(Hostile, ArchiveWithoutADat) {
  Bytes archive = packed(small_dat());
  archive[archive.size() - 23] = 'x';  // the last letter of the last name in the directory
  EXPECT_EQ(LogView::open(archive).error(),
            (WireError{WireErrorReason::bad_value, archive.size(), "dat_entry"}));
}

/// The archive of small_dat() with one value changed in the central header of its .dat. Before the end of the
/// archive are 22 bytes of end record, 26 bytes of name and 46 bytes of header.
template <class Value>
Bytes with_central(std::size_t offset, Value value) {
  Bytes archive = packed(small_dat());
  patch(archive, archive.size() - 22 - 26 - 46 + offset, value);
  return archive;
}

TEST(Hostile, DirectoriesThatLie) {
  const std::size_t size = packed(small_dat()).size();
  using enum WireErrorReason;
  EXPECT_EQ(LogView::open(with_central<std::uint32_t>(0, 0)).error().field, "central_signature");
  EXPECT_EQ(LogView::open(with_central<std::uint32_t>(42, 1)).error(),
            (WireError{bad_value, 1, "local_signature"}));
  EXPECT_EQ(LogView::open(with_central<std::uint32_t>(42, 0xFFFFFFFF)).error(),
            (WireError{truncated, 0, "local_header"}));
  EXPECT_EQ(LogView::open(with_central<std::uint16_t>(10, 12)).error().field, "method");
  EXPECT_EQ(LogView::open(with_central<std::uint16_t>(8, 1)).error().field, "method") << "encrypted";
  EXPECT_EQ(LogView::open(with_central<std::uint32_t>(20, static_cast<std::uint32_t>(size))).error().field,
            "entry_data");
  EXPECT_EQ(LogView::open(with_central<std::uint32_t>(24, 1)).error().field, "entry_data") << "another size";
  EXPECT_EQ(LogView::open(with_central<std::uint16_t>(10, 0)).error().field, "size") << "method 0, two sizes";
}

// Every bit of the header of the first block of the .dat, which follows the .cfg of 14 bytes.
TEST(Hostile, BrokenBlockHeadersAreRefused) {
  constexpr std::size_t block = 30 + 25 + 14 + 10 + 30 + 26;
  const Bytes archive = packed(small_dat());
  ASSERT_EQ(archive[block + 5], '*');
  for (std::size_t bit = 0; bit < 40; ++bit) {
    Bytes broken = archive;
    broken[block + bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    const auto view = LogView::open(broken);
    // The lowest bit marks the final block, which may hold data too. The upper five bits of the first byte
    // have no meaning before a stored block.
    const bool harmless = bit == 0 || (bit >= 3 && bit < 8);
    ASSERT_EQ(view.has_value(), harmless) << bit;
    if (!harmless) {
      EXPECT_EQ(view.error().field, "entry_data") << bit;
    }
  }
}

TEST(Hostile, BrokenConfigIsRefusedByItsCrc) {
  Bytes archive = packed(small_dat());
  archive[30 + 25 + 5] ^= 1U;
  EXPECT_EQ(LogView::open(archive).error(), (WireError{WireErrorReason::bad_value, 55, "crc"}));
}

/// A deflate stream of `size` zeros: fixed codes, a literal and then matches of 258 at distance 1.
Bytes deflated_zeros(std::uint64_t size) {
  Bytes zlib = *deflate_shorter(Bytes(size), 9);
  return {zlib.begin() + 2, zlib.end() - 4};  // without the header and the checksum of zlib
}

/// An archive whose .dat is the deflate stream `stream`, with `size` bytes as its stated unpacked size.
Bytes compressed_archive(const Bytes& stream, std::uint32_t size, std::uint32_t crc) {
  Bytes local = from_hex("50 4B 03 04 14 00 00 00 08 00 00 00 00 00");
  Bytes entry(16);
  patch(entry, 0, crc);
  patch(entry, 4, static_cast<std::uint32_t>(stream.size()));
  patch(entry, 8, size);
  patch<std::uint16_t>(entry, 12, 5);
  const Bytes name{'a', '.', 'd', 'a', 't'};
  const Bytes central = from_hex("50 4B 01 02 14 00 14 00 00 00 08 00 00 00 00 00");
  Bytes end = from_hex("50 4B 05 06 00 00 00 00 01 00 01 00 33 00 00 00 00 00 00 00 00 00");
  patch(end, 16, static_cast<std::uint32_t>(35 + stream.size()));
  return joined({local, entry, name, stream, central, entry, Bytes(14), name, end});
}

TEST(Hostile, BombsAreHeldToTheLimit) {
  constexpr std::uint32_t size = 10'000'000;
  const Bytes zeros = deflated_zeros(size);
  EXPECT_LT(zeros.size(), 10'500U);
  Crc32 crc;
  crc.add(Bytes(size));
  const Bytes archive = compressed_archive(zeros, size, crc.value());
  const auto view = LogView::open(archive, size);
  ASSERT_TRUE(view);
  EXPECT_EQ(view->index().tail_size, size);
  EXPECT_EQ(LogView::open(archive, size - 1).error(), (WireError{WireErrorReason::bad_length, 35, "size"}));
  EXPECT_EQ(LogView::open(compressed_archive(zeros, size, 0)).error().field, "crc");
  // Stated sizes: more than the stream holds, less than it holds, more than any stream of its length can
  // hold.
  EXPECT_EQ(LogView::open(compressed_archive(zeros, size + 1, crc.value())).error().field, "entry_data");
  EXPECT_EQ(LogView::open(compressed_archive(zeros, size - 1, crc.value())).error().field, "entry_data");
  EXPECT_EQ(LogView::open(compressed_archive(zeros, 1'000'000'000, crc.value())).error().field, "entry_data");
}

TEST(Hostile, CompressedLogsAreUnpacked) {
  const Bytes dat = small_dat();
  const Bytes zlib = *deflate_shorter(dat, 9);
  Crc32 crc;
  crc.add(dat);
  const Bytes archive = compressed_archive({zlib.begin() + 2, zlib.end() - 4},
                                           static_cast<std::uint32_t>(dat.size()), crc.value());
  auto view = LogView::open(archive);
  ASSERT_TRUE(view);
  const LogView moved = std::move(*view);
  ASSERT_EQ(moved.index().records.size(), 4U);
  EXPECT_EQ(*moved.image(moved.index().records[3]), patterned_image(2));
}

// Each file either opens or returns an error. The sanitizers check the rest.
TEST(Hostile, FlippedBitsNeverDoMoreThanDamage) {
  std::mt19937 random{4};
  const std::vector<Bytes> wholes{small_dat(), packed(small_dat())};
  std::size_t decoded = 0;
  for (int round = 0; round < 20'000; ++round) {
    Bytes file = wholes[static_cast<std::size_t>(round) % 2];
    const auto flips = 1 + random() % 4;
    for (unsigned i = 0; i < flips; ++i) {
      file[random() % file.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    }
    const auto view = LogView::open(file, 1 << 20);
    if (!view) {
      EXPECT_LE(view.error().offset, file.size());
      continue;
    }
    const DatIndex& index = view->index();
    std::uint64_t end = 0;
    for (const RecordEntry& entry : index.records) {
      EXPECT_GE(entry.offset, end);
      end = entry.offset + entry.size;
      decoded +=
          entry.type == RecordType::image ? view->image(entry).has_value() : view->status(entry).has_value();
    }
    EXPECT_LE(end, index.whole_size);
    EXPECT_TRUE(index.closed || index.tail_size > 0);
  }
  EXPECT_GT(decoded, 20'000U) << "most flips hit one record of four";
}

}  // namespace
}  // namespace sonard::glf::testing
