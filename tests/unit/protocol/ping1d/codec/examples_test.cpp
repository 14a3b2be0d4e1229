// SPDX-License-Identifier: Apache-2.0
// The messages of tests/data/ping1d in both directions: bytes to values, and values to bytes.
#include <gtest/gtest.h>

#include "protocol/ping1d/codec.hpp"
#include "protocol/ping1d/layout.hpp"
#include "tests/support/message_fields.hpp"

namespace sonard::ping1d::testing {
namespace {

using sonard::testing::Bytes;
using sonard::testing::Json;
using sonard::testing::Message;
using sonard::testing::take;

class Ping1dMessage : public ::testing::TestWithParam<Message> {};

/// Takes the fields by the layout table of a message, its text and its points.
template <class Any>
void take_body(Json& fields, const std::string& name, Any& message) {
  if constexpr (requires { Layout<Any>::size; }) {
    sonard::testing::take_fields<Layout<Any>>(fields, name, message);
  }
  if constexpr (requires { message.text; }) {
    message.text = take(fields, "text");
  }
  if constexpr (requires { message.data; }) {
    sonard::testing::set(message.data, take(fields, "data"));
  }
}

TEST_P(Ping1dMessage, BytesAndFieldsMeanTheSame) {
  const Message& example = GetParam();
  const auto check = [&](const auto& decoded) {
    ASSERT_TRUE(decoded) << to_string(decoded.error());
    const auto described = expect_fields(example, *decoded, [&](Json& fields, auto& message) {
      const Json frame = take(fields, "frame");
      const FrameHeader header{frame.at("payload_length"), frame.at("message_id"), frame.at("source"),
                               frame.at("destination")};
      EXPECT_EQ(frame_header(example.bytes), header);
      take_body(fields, example.message, message);
    });
    EXPECT_EQ(encode(described), example.bytes);
  };
  example.from_head ? check(decode_report(example.bytes)) : check(decode_command(example.bytes));
}
INSTANTIATE_TEST_SUITE_P(all, Ping1dMessage,
                         ::testing::ValuesIn(sonard::testing::complete_messages("ping1d")),
                         sonard::testing::message_name);

TEST(Ping1dExamples, CoverEveryMessage) {
  sonard::testing::expect_every_alternative<Command>("ping1d", false, decode_command, 1);  // all but Unknown
  sonard::testing::expect_every_alternative<Report>("ping1d", true, decode_report, 1);
}

TEST(Ping1dExamples, AnEmptyMessageIsARequestForIt) {
  const Bytes general_info{0x42, 0x52, 0x00, 0x00, 0xBA, 0x04, 0x00, 0x00, 0x52, 0x01};
  const Bytes distance_simple{0x42, 0x52, 0x00, 0x00, 0xBB, 0x04, 0x00, 0x00, 0x53, 0x01};
  EXPECT_TRUE(decode_command(general_info).value() == Command{GeneralRequest{1210}});
  EXPECT_TRUE(decode_command(distance_simple).value() == Command{GeneralRequest{1211}});
}

TEST(Ping1dExamples, EveryFrameIsFoundBehindJunk) {
  for (const Message& message : sonard::testing::messages_of("ping1d")) {
    Bytes stream{0x00, 0xFF, 0x55, 0x55, 0x55};
    stream.insert(stream.end(), message.bytes.begin(), message.bytes.end());
    FrameBuffer buffer;
    buffer.append({}, stream);
    const auto found = buffer.front();
    ASSERT_TRUE(found) << message.name;
    EXPECT_EQ(Bytes(found->begin(), found->end()), message.bytes);
  }
}

}  // namespace
}  // namespace sonard::ping1d::testing
