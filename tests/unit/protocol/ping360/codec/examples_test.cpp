// SPDX-License-Identifier: Apache-2.0
// The messages of tests/data/ping360 in both directions: bytes to values, and values to bytes.
#include <gtest/gtest.h>

#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/layout.hpp"
#include "tests/support/message_fields.hpp"
#include "tests/unit/protocol/ping360/codec/fixture.hpp"

namespace sonard::ping360::testing {
namespace {

using sonard::testing::Json;
using sonard::testing::Message;
using sonard::testing::set;
using sonard::testing::take;

class Ping360Message : public ::testing::TestWithParam<Message> {};

/// Takes the fields by the layout table of a message, its text and its samples.
template <class Any>
void take_body(Json& fields, const std::string& name, Any& message) {
  if constexpr (requires { Layout<Any>::size; }) {
    sonard::testing::take_fields<Layout<Any>>(fields, name, message);
  }
  if constexpr (requires { message.text; }) {
    message.text = take(fields, "text");
  }
  if constexpr (requires { message.data; }) {
    set(message.data, take(fields, "data"));
  }
}

TEST_P(Ping360Message, BytesAndFieldsMeanTheSame) {
  const Message& example = GetParam();
  const auto check = [&](const auto& decoded) {
    ASSERT_TRUE(decoded) << to_string(decoded.error());
    FrameHeader header;
    const auto described = expect_fields(example, *decoded, [&](Json& fields, auto& message) {
      const Json frame = take(fields, "frame");
      header = {frame.at("payload_length"), frame.at("message_id"), frame.at("source"),
                frame.at("destination")};
      take_body(fields, example.message, message);
    });
    EXPECT_EQ(frame_header(example.bytes), header);
    EXPECT_EQ(
        header.destination == 0 ? encode(described) : encode(described, header.source, header.destination),
        example.bytes);
  };
  example.from_head ? check(decode_report(example.bytes)) : check(decode_command(example.bytes));
}
INSTANTIATE_TEST_SUITE_P(all, Ping360Message,
                         ::testing::ValuesIn(sonard::testing::complete_messages("ping360")),
                         sonard::testing::message_name);

TEST(Ping360Examples, CoverEveryMessage) {
  // All but Unknown, which is no message, and a report that is also a command.
  sonard::testing::expect_every_alternative<Command>("ping360", false, decode_command, 1);
  sonard::testing::expect_every_alternative<Report>("ping360", true, decode_report, 2);
}

TEST(Ping360Examples, AHeadMaySayItsIdWithTheMessageThatSetsIt) {
  const Bytes bytes = load_fixture("set_device_id");
  EXPECT_TRUE(*decode_report(bytes) == Report{SetDeviceId{7}});
}

TEST(Ping360Examples, EveryFrameIsFoundBehindJunk) {
  for (const std::string& name : fixture_names()) {
    Bytes stream{0x00, 0xFF, 0x55, 0x55, 0x55};
    const Bytes frame = load_fixture(name);
    stream.insert(stream.end(), frame.begin(), frame.end());
    FrameBuffer buffer;
    buffer.append({}, stream);
    const auto found = buffer.front();
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(Bytes(found->begin(), found->end()), frame);
    EXPECT_EQ(buffer.dropped(), 5U);
    EXPECT_TRUE(buffer.take_baud_bytes());
  }
}

}  // namespace
}  // namespace sonard::ping360::testing
