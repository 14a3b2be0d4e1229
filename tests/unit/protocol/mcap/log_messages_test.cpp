// SPDX-License-Identifier: Apache-2.0
// Messages of log files: their schema describes them, and inconsistent images are reported.
#include "protocol/log/log_messages.hpp"

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <gtest/gtest.h>

#include <memory>

namespace sonard::log {
namespace {

SonarImage image() {
  SonarImage message;
  message.set_head("bow");
  message.set_range_lines(2);
  message.set_beams(3);
  message.set_pixels("abcdef");
  for (const double bearing : {0.5, 0.0, -0.5}) {
    message.add_bearings_rad(bearing);
  }
  message.mutable_t_world_sonar()->mutable_position_m()->set_z(-3);
  return message;
}

TEST(LogMessages, SchemaAloneIsEnoughToReadAMessage) {
  google::protobuf::FileDescriptorSet set;
  const auto bytes = schema_data(*SonarImage::descriptor());
  ASSERT_TRUE(set.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
  google::protobuf::DescriptorPool pool;  // an empty pool, without the project's own messages
  for (const auto& file : set.file()) {
    ASSERT_NE(pool.BuildFile(file), nullptr) << file.name() << " comes before what it imports";
  }
  const auto* descriptor = pool.FindMessageTypeByName("sonard.log.SonarImage");
  ASSERT_NE(descriptor, nullptr);
  google::protobuf::DynamicMessageFactory factory;
  const std::unique_ptr<google::protobuf::Message> read{factory.GetPrototype(descriptor)->New()};
  const auto encoded = encode(image());
  ASSERT_TRUE(read->ParseFromArray(encoded.data(), static_cast<int>(encoded.size())));
  EXPECT_EQ(read->GetReflection()->GetString(*read, descriptor->FindFieldByName("pixels")), "abcdef");
}

TEST(LogMessages, AnImageHasAPixelAndABearingForEachBeam) {
  EXPECT_FALSE(problem_of(image()));
  SonarImage few = image();
  few.set_pixels("abcde");
  EXPECT_EQ(problem_of(few), "2 lines of 3 beams have 5 pixels");
  SonarImage bearings = image();
  bearings.add_bearings_rad(1);
  EXPECT_EQ(problem_of(bearings), "3 beams have 4 bearings");
}

// Programs count these messages and print a line of their own.
TEST(LogMessages, ATextThatIsNotUtf8IsRefusedWithoutALineOfTheLibrary) {
  const std::vector<std::uint8_t> head_is_ff{0x0A, 1, 0xFF};  // field 1 of 1 byte
  SonarImage message;
  message.set_head("\xFF");
  testing::internal::CaptureStderr();
  EXPECT_FALSE(decode<SonarImage>(head_is_ff));
  encode(message);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(LogMessages, BytesOfSomethingElseAreRefused) {
  const auto encoded = encode(image());
  EXPECT_TRUE(decode<SonarImage>(encoded));
  EXPECT_FALSE(decode<SonarImage>(std::span{encoded}.first(encoded.size() - 1)));
}

}  // namespace
}  // namespace sonard::log
