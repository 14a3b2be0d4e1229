// SPDX-License-Identifier: Apache-2.0
// Files of packets, whole and damaged.
#include "protocol/sonar3d15/recording.hpp"

#include <gtest/gtest.h>

#include <string>

#include "protocol/sonar3d15/codec.hpp"
#include "tests/support/messages.hpp"

namespace sonard::sonar3d15 {
namespace {

using sonard::testing::Bytes;
using sonard::testing::message_bytes;

const std::vector<std::string> names{"range_image", "signal_image", "range_image_compressed", "imu_batch"};

Bytes file_of(const std::vector<Bytes>& parts) {
  Bytes file;
  for (const Bytes& part : parts) {
    file.insert(file.end(), part.begin(), part.end());
  }
  return file;
}

std::vector<Bytes> packets() {
  std::vector<Bytes> all;
  for (const std::string& name : names) {
    all.push_back(message_bytes("sonar3d15", name));
  }
  return all;
}

struct Read {
  std::vector<Bytes> packets;
  std::vector<Damage> damages;
};
Read read(const Bytes& file) {
  Read result;
  result.damages = for_each_packet(file, [&](std::span<const std::uint8_t> packet) {
    result.packets.emplace_back(packet.begin(), packet.end());
  });
  return result;
}

TEST(Recording, PacketsOfBothKindsFollowEachOther) {
  const Read result = read(file_of(packets()));
  EXPECT_EQ(result.packets, packets());
  EXPECT_TRUE(result.damages.empty());
  EXPECT_TRUE(read({}).packets.empty());
}

TEST(Recording, ADamagedPacketIsSkippedAndItsOffsetReported) {
  std::vector<Bytes> parts = packets();
  const std::size_t first = parts[0].size(), second = parts[1].size();
  parts[1][20] ^= 1;
  const Read result = read(file_of(parts));
  EXPECT_EQ(result.packets, (std::vector<Bytes>{parts[0], parts[2], parts[3]}));
  ASSERT_EQ(result.damages.size(), 1U);
  EXPECT_EQ(result.damages[0].offset, first);
  EXPECT_EQ(result.damages[0].size, second);
  EXPECT_EQ(result.damages[0].error, (WireError{WireErrorReason::bad_value, first + second - 4, "crc"}));
}

TEST(Recording, NoiseBetweenPacketsIsOneDamageAlsoIfItContainsAnId) {
  const Bytes noise{'R', 'I', 'P', '1', 'R', 'I', 'P', '2', 12, 0, 0, 0, 1, 2, 3, 4, 'R', 'R', 'I'};
  const Read result = read(file_of({packets()[0], noise, packets()[1]}));
  EXPECT_EQ(result.packets, (std::vector<Bytes>{packets()[0], packets()[1]}));
  ASSERT_EQ(result.damages.size(), 1U);
  EXPECT_EQ(result.damages[0].size, noise.size());
}

TEST(Recording, AFileCutAnywhereKeepsItsWholePackets) {
  const Bytes file = file_of(packets());
  for (std::size_t size = 0; size < file.size(); ++size) {
    const Read result = read({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)});
    std::size_t kept = 0;
    for (const Bytes& packet : result.packets) {
      kept += packet.size();
    }
    ASSERT_EQ(result.damages.size(), kept < size ? 1U : 0U);
    if (kept < size) {
      EXPECT_EQ(result.damages[0].offset, kept);
      EXPECT_EQ(result.damages[0].size, size - kept);
    }
  }
}

}  // namespace
}  // namespace sonard::sonar3d15
