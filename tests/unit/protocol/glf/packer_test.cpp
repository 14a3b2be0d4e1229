// SPDX-License-Identifier: Apache-2.0
// The archive around a .dat: its bytes written out by hand, its sizes by the formulas of
// protocol/glf/README.md 1.2.
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/unit/protocol/glf/fixture.hpp"

namespace sonard::glf::testing {
namespace {

Bytes text(const std::string& characters) {
  return {characters.begin(), characters.end()};
}

// CRC-32 of "<a/>" is 0x01D11CD4, of "123456789" 0xCBF43926. 14:22:33 is 14 << 11 | 22 << 5 | 33 / 2 =
// 0x72D0, 2026-11-20 is 46 << 9 | 11 << 5 | 20 = 0x5D74. Names have 25 and 26 characters. 4 bytes are stored
// in 14, 9 in 19: the local header of the .dat is at 30 + 25 + 14 = 69 = 0x45, the directory at 69 + 30 + 26
// + 19 = 144 = 0x90; it has 2 * 46 + 25 + 26 = 143 = 0x8F bytes.
TEST(Packer, ArchiveIsWhatReadersExpect) {
  const Bytes config_entry =
      from_hex("14 00 00 00 08 00 D0 72 74 5D D4 1C D1 01 0E 00 00 00 04 00 00 00 19 00 00 00");
  const Bytes dat_entry =
      from_hex("14 00 00 00 08 00 D0 72 74 5D 26 39 F4 CB 13 00 00 00 09 00 00 00 1A 00 00 00");
  const Bytes config_file = text("log_2026-11-20-142233.cfg");
  const Bytes dat_file = text("data_2026-11-20-142233.dat");
  const Bytes local = from_hex("50 4B 03 04");
  const Bytes central = from_hex("50 4B 01 02 14 00");
  const Bytes final_block = from_hex("01 00 00 FF FF");
  const Bytes attributes = from_hex("00 00 00 00 00 00 00 00 00 00");
  EXPECT_EQ(packed(text("123456789"), "<a/>"),
            joined({local,
                    config_entry,
                    config_file,  //
                    from_hex("00 04 00 FB FF"),
                    text("<a/>"),
                    final_block,  //
                    local,
                    dat_entry,
                    dat_file,  //
                    from_hex("00 09 00 F6 FF"),
                    text("123456789"),
                    final_block,  //
                    central,
                    config_entry,
                    attributes,
                    from_hex("00 00 00 00"),
                    config_file,  //
                    central,
                    dat_entry,
                    attributes,
                    from_hex("45 00 00 00"),
                    dat_file,  //
                    from_hex("50 4B 05 06 00 00 00 00 02 00 02 00 8F 00 00 00 90 00 00 00 00 00")}));
}

// A reader finds a byte of the .dat at dataStart + (off / 65531) * 65536 + 5 + off % 65531.
TEST(Packer, PositionsFollowTheFormula) {
  std::mt19937 random{3};
  for (const std::size_t size : {1U, 65'530U, 65'531U, 65'532U, 131'062U, 200'000U}) {
    Bytes dat(size);
    std::generate(dat.begin(), dat.end(), [&] { return static_cast<std::uint8_t>(random()); });
    const Bytes archive = packed(dat, "<a/>");
    const std::size_t start = 30 + 25 + 4 + 10 + 30 + 26;
    for (std::size_t offset = 0; offset < size; ++offset) {
      ASSERT_EQ(archive[start + offset / 65'531 * 65'536 + 5 + offset % 65'531], dat[offset]) << offset;
    }
    const std::size_t blocks = (size + 65'530) / 65'531 + 1;
    EXPECT_EQ(value_at<std::uint32_t>(archive, start - 26 - 12), size + 5 * blocks) << "compressed size";
    EXPECT_EQ(archive.size(), start + size + 5 * blocks + 143 + 22);
  }
}

TEST(Packer, RefusesWhatReadersCannotFind) {
  const auto pack = [](std::size_t config_size, std::uint64_t dat_size) {
    return Packer{"s", std::string(config_size, ' '), {.size = dat_size}, {}};
  };
  EXPECT_NO_THROW(pack(65'531, 2'000'000'000));
  EXPECT_THROW(pack(65'532, 2), std::invalid_argument);
  EXPECT_THROW(pack(0, 2), std::invalid_argument);
  EXPECT_THROW(pack(1, 2'000'000'001), std::invalid_argument);
}

}  // namespace
}  // namespace sonard::glf::testing
