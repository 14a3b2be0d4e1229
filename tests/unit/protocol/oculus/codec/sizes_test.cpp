// SPDX-License-Identifier: Apache-2.0
// The checks that clients make on a ping, for every form of ping (protocol/oculus/README.md 4.3).
#include <gtest/gtest.h>

#include <tuple>

#include "protocol/oculus/image_form.hpp"
#include "tests/unit/protocol/oculus/codec/fixture.hpp"

namespace sonard::oculus::testing {
namespace {

std::uint32_t u32_at(const Bytes& bytes, std::size_t offset) {
  return bytes[offset] | bytes[offset + 1] << 8 | bytes[offset + 2] << 16 |
         static_cast<std::uint32_t>(bytes[offset + 3]) << 24;
}

/// Version, bits, row gains, beams, mode.
using Form = std::tuple<int, int, bool, int, int>;
class OculusSizes : public ::testing::TestWithParam<Form> {};

TEST_P(OculusSizes, FitEachOther) {
  const auto [version, bits, gains, beams, mode] = GetParam();
  PingResult ping;
  ping.fire.version = static_cast<std::uint16_t>(version);
  ping.fire.fire.master_mode = static_cast<std::uint8_t>(mode);
  ping.fire.fire.flags = static_cast<std::uint8_t>(0x09 | (bits > 8 ? 0x02 : 0) | (gains ? 0x04 : 0) |
                                                   (beams == 512 ? 0x40 : 0));
  if (version == 2) {
    ping.fire.extension = FireExtension{bits == 32 ? 0x200U : 0U, {}};
  }
  ping.data_size = data_size_of(ping.fire);
  ASSERT_EQ(static_cast<int>(bytes_per_sample(ping.data_size)) * 8, bits);
  ASSERT_EQ(beams_of(ping.fire.fire), beams);
  ping.bearings_cdeg = bearings_cdeg(beams, mode == 1 ? 65.0 : 30.0);
  ping.ranges = 703;
  ping.image_offset = usual_image_offset(version == 2, beams);
  const std::size_t image_size = 703U * static_cast<std::size_t>(beams * bits / 8 + (gains ? 4 : 0));
  const Bytes image(image_size, 7);
  ping.image = image;

  const Bytes bytes = encode(ping, m1200d);
  const std::size_t tail = version == 2 ? 190 : 110;
  EXPECT_EQ(u32_at(bytes, tail), 2048U);
  EXPECT_EQ(u32_at(bytes, tail + 4), image_size);
  EXPECT_EQ(u32_at(bytes, tail + 8), bytes.size());
  EXPECT_EQ(u32_at(bytes, 10) + 16, bytes.size());
  EXPECT_EQ(bytes.size(), 2048 + image_size);
  EXPECT_TRUE(decode_ping_result(bytes));

  Bytes broken = bytes;
  broken.pop_back();
  EXPECT_FALSE(decode_ping_result(broken));
}

std::vector<Form> forms() {
  std::vector<Form> all;
  for (const bool gains : {false, true}) {
    for (const int beams : {256, 512}) {
      for (const int mode : {1, 2}) {
        for (const int bits : {8, 16, 32}) {
          if (bits < 32) {
            all.emplace_back(1, bits, gains, beams, mode);
          }
          all.emplace_back(2, bits, gains, beams, mode);
        }
      }
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(all, OculusSizes, ::testing::ValuesIn(forms()));

}  // namespace
}  // namespace sonard::oculus::testing
