// SPDX-License-Identifier: Apache-2.0
// The packets of tests/data/sonar3d15 in both directions, and the points that a client computes from one of
// them (acceptance 1 and 5).
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "protocol/sonar3d15/codec.hpp"
#include "protocol/sonar3d15/layout.hpp"
#include "protocol/sonar3d15/shot.hpp"
#include "tests/support/message_fields.hpp"

namespace sonard::sonar3d15 {
namespace {

using sonard::testing::Json;
using sonard::testing::messages_of;

struct Example : ::testing::TestWithParam<sonard::testing::Message> {};

const google::protobuf::Message* protobuf_of(const Message& message) {
  return std::visit(
      []<class M>(const M& it) -> const google::protobuf::Message* {
        if constexpr (std::is_same_v<M, Unknown>) {
          return nullptr;
        } else {
          return &it;
        }
      },
      message);
}

TEST_P(Example, BytesAndFieldsMeanTheSame) {
  const auto& example = GetParam();
  Json fields = example.fields;
  PacketHeader header;
  sonard::testing::take_fields<PacketLayout>(fields, "packet", header);
  EXPECT_EQ(header.length, example.bytes.size());
  const auto decoded = decode(example.bytes);
  ASSERT_TRUE(decoded) << to_string(decoded.error());
  const google::protobuf::Message* const message = protobuf_of(*decoded);
  ASSERT_NE(message, nullptr);
  EXPECT_EQ(message->GetDescriptor()->name(), example.message);

  const std::unique_ptr<google::protobuf::Message> described(message->New());
  const auto read = google::protobuf::util::JsonStringToMessage(
      sonard::testing::take(fields, "message").dump(), described.get());
  ASSERT_TRUE(read.ok()) << read.ToString();
  EXPECT_TRUE(fields.empty()) << fields;
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(*message, *described));

  const std::vector<std::uint8_t> encoded = encode(*described, header.id);
  if (example.is_written) {
    EXPECT_EQ(encoded, example.bytes);
  } else {  // another legal block of Snappy
    const auto again = decode(encoded);
    ASSERT_TRUE(again);
    EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(*protobuf_of(*again), *described));
  }
}
INSTANTIATE_TEST_SUITE_P(all, Example, ::testing::ValuesIn(messages_of("sonar3d15")),
                         sonard::testing::message_name);

TEST(Geometry, PixelsAreThePointsOfTheExample) {
  const auto message = decode(sonard::testing::message_bytes("sonar3d15", "range_image"));
  const RangeImage& image = std::get<RangeImage>(*message);
  constexpr std::array<std::array<double, 3>, 8> points{{{0, 0, 0},
                                                         {0.907, -0.243, 0.342},
                                                         {1.815, 0.486, 0.684},
                                                         {1.993, 1.993, 1.026},
                                                         {2.657, -2.657, -1.368},
                                                         {4.538, -1.216, -1.710},
                                                         {0, 0, 0},
                                                         {3.987, 3.987, -2.052}}};
  for (int pixel = 0; pixel < 8; ++pixel) {
    const double r = distance_m(image, pixel);
    const double yaw = column_rad(image, pixel % 4), pitch = row_rad(image, pixel / 4);
    const auto& point = points[static_cast<std::size_t>(pixel)];
    EXPECT_NEAR(r * std::cos(pitch) * std::cos(yaw), point[0], 6e-4);
    EXPECT_NEAR(r * std::cos(pitch) * std::sin(yaw), point[1], 6e-4);
    EXPECT_NEAR(-r * std::sin(pitch), point[2], 6e-4);
  }
}

TEST(Sizes, ALargeImageWithoutCompressionFitsADatagram) {
  RangeImage image;
  image.set_width(256);
  image.set_height(64);
  image.mutable_image_pixel_data()->Resize(256 * 64, 65'535);
  const auto plain = encode(image, PacketId::rip1);
  EXPECT_GT(plain.size(), 49'152U);
  EXPECT_LT(plain.size(), most_packet_size);
  EXPECT_LT(encode(image, PacketId::rip2).size(), plain.size() / 10);
}

}  // namespace
}  // namespace sonard::sonar3d15
