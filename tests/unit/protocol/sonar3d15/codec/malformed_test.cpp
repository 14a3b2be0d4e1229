// SPDX-License-Identifier: Apache-2.0
// Packets that clients refuse, and messages that they skip (acceptance 1).
#include <gtest/gtest.h>
#include <zlib.h>

#include "protocol/sonar3d15/codec.hpp"
#include "tests/support/messages.hpp"

namespace sonard::sonar3d15 {
namespace {

using sonard::testing::Bytes;
using sonard::testing::message_bytes;

Bytes example() {
  return message_bytes("sonar3d15", "range_image");
}

void expect_error(const Bytes& packet, WireErrorReason reason, std::size_t offset, std::string_view field) {
  const auto message = decode(packet);
  ASSERT_FALSE(message) << field;
  EXPECT_EQ(message.error(), (WireError{reason, offset, field})) << to_string(message.error());
}

TEST(Malformed, AnyChangedByteIsAnError) {
  for (std::size_t i = 0; i < example().size(); ++i) {
    Bytes packet = example();
    packet[i] ^= 0x10;
    EXPECT_FALSE(decode(packet)) << i;
  }
}

TEST(Malformed, ErrorsNameTheField) {
  Bytes packet = example();
  packet[3] = '3';
  expect_error(packet, WireErrorReason::bad_value, 0, "id");
  packet = example();
  packet[4] = 11;
  expect_error(packet, WireErrorReason::bad_length, 4, "length");
  packet = example();
  packet[6] = 1;
  expect_error(packet, WireErrorReason::bad_length, 4, "length");
  packet = example();
  packet.back() ^= 1;
  expect_error(packet, WireErrorReason::bad_value, 135, "crc");
  packet = example();
  packet.push_back(0);
  expect_error(packet, WireErrorReason::bad_length, 4, "length");
}

TEST(Malformed, APacketCutAnywhereIsAnError) {
  for (std::size_t size = 0; size < example().size(); ++size) {
    Bytes packet = example();
    packet.resize(size);
    const auto message = decode(packet);
    ASSERT_FALSE(message);
    EXPECT_EQ(message.error().reason, WireErrorReason::truncated);
  }
}

/// A packet RIP2 with this block of Snappy.
Bytes with_block(Bytes block) {
  Bytes packet{'R', 'I', 'P', '2', static_cast<std::uint8_t>(block.size() + 12), 0, 0, 0};
  packet.insert(packet.end(), block.begin(), block.end());
  const auto crc = static_cast<std::uint32_t>(crc32_z(0, packet.data(), packet.size()));
  for (int byte = 0; byte < 4; ++byte) {
    packet.push_back(static_cast<std::uint8_t>(crc >> (8 * byte)));
  }
  return packet;
}

TEST(Malformed, ABlockOfSnappyThatEndsEarlyOrExpandsTooFarIsAnError) {
  const Bytes whole = message_bytes("sonar3d15", "range_image_compressed");
  const Bytes block(whole.begin() + 8, whole.end() - 4);
  EXPECT_EQ(with_block(block), whole);
  for (std::size_t size = 0; size < block.size(); ++size) {
    expect_error(with_block({block.begin(), block.begin() + static_cast<std::ptrdiff_t>(size)}),
                 WireErrorReason::bad_value, 8, "payload");
  }
  Bytes long_block = block;
  long_block[0] = 0xFF;  // with three bytes more: a length of 2 GB
  long_block.insert(long_block.begin() + 1, {0xFF, 0xFF, 0xFF, 0x07});
  expect_error(with_block(long_block), WireErrorReason::bad_value, 8, "payload");
}

TEST(Malformed, AMessageOfAnotherTypeIsUnknown) {
  google::protobuf::Timestamp other;
  other.set_seconds(1);
  const auto message = decode(encode(other, PacketId::rip2));
  ASSERT_TRUE(message);
  EXPECT_EQ(std::get<Unknown>(*message).type, "google.protobuf.Timestamp");
}

TEST(Malformed, AnImageHasAsManyPixelsAsItSays) {
  RangeImage image;
  image.set_width(4);
  image.set_height(2);
  image.mutable_image_pixel_data()->Resize(7, 1);
  expect_error(encode(image, PacketId::rip1), WireErrorReason::bad_length, 8, "image_pixel_data");
  BitmapImageGreyscale8 signal;
  signal.set_width(65'536);
  signal.set_height(65'536);
  expect_error(encode(signal, PacketId::rip2), WireErrorReason::bad_length, 8, "image_pixel_data");
  ImuBatch batch;
  batch.set_samples(1);
  EXPECT_FALSE(decode(encode(batch, PacketId::rip2)));
}

}  // namespace
}  // namespace sonard::sonar3d15
