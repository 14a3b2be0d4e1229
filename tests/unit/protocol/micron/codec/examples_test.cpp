// SPDX-License-Identifier: Apache-2.0
// The messages of tests/data/micron in both directions: bytes to values, and values to bytes.
#include <gtest/gtest.h>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/layout.hpp"
#include "tests/support/message_fields.hpp"
#include "tests/unit/protocol/micron/codec/fixture.hpp"

namespace sonard::micron {

inline void set(PortSettings& port, const nlohmann::json& json) {
  nlohmann::json fields{{"port", json}};
  sonard::testing::take_fields<Layout<PortSettings>>(fields, "port", port);
}

}  // namespace sonard::micron

namespace sonard::micron::testing {
namespace {

using sonard::testing::Json;
using sonard::testing::Message;
using sonard::testing::set;
using sonard::testing::take;
using sonard::testing::take_fields;

// ---- The fields of a message: by its table, and what no table holds

template <class Any>
concept HasLayout = requires {
  Layout<Any>::size;
};

template <class Any>
void take_body(Json& fields, const std::string& name, Any& message) {
  if constexpr (HasLayout<Any>) {
    take_fields<Layout<Any>>(fields, name, message);
  }
}

void take_body(Json& fields, const std::string& name, HeadCommand& command) {
  take_fields<Layout<HeadCommand>>(fields, name, command);
  if (fields.contains("gain_block")) {
    take_fields<Layout<GainBlock>>(fields, "gain_block", command.gain_block.emplace());
  }
}

void take_body(Json& fields, const std::string&, GainCommand& command) {
  take_fields<Layout<GainBlock>>(fields, "gain_block", command.values);
}

void take_body(Json& fields, const std::string& name, HeadData& line) {
  take_fields<Layout<HeadData>>(fields, name, line);
  set(line.data, take(fields, "data"));
}

void take_body(Json& fields, const std::string& name, BBUserData& blocks) {
  take_fields<Layout<BBUserData>>(fields, name, blocks);
  set(blocks.dst_half_duplex.emplace(), take(fields, "bb_user_data_dst").at("dst_half_duplex"));
}

void take_body(Json& fields, const std::string&, AuxData& aux) {
  set(aux.data, take(fields, "data"));
}

// ---- Both directions

class MicronMessage : public ::testing::TestWithParam<Message> {};

TEST_P(MicronMessage, BytesAndFieldsMeanTheSame) {
  const Message& example = GetParam();
  const auto check = [&](const auto& decoded) {
    ASSERT_TRUE(decoded) << to_string(decoded.error());
    EXPECT_EQ(example.wireshark.at("frame.type"), type_of(*decoded));
    const auto described = expect_fields(
        example, *decoded, [&](Json& fields, auto& message) { take_body(fields, example.message, message); });
    EXPECT_EQ(encode(described), example.bytes);
  };
  example.from_head ? check(decode_report(example.bytes)) : check(decode_command(example.bytes));
}
INSTANTIATE_TEST_SUITE_P(all, MicronMessage,
                         ::testing::ValuesIn(sonard::testing::complete_messages("micron")),
                         sonard::testing::message_name);

TEST(Examples, CoverEveryMessage) {
  // All but Unknown, which is no message.
  sonard::testing::expect_every_alternative<Command>("micron", false, decode_command, 1);
  sonard::testing::expect_every_alternative<Report>("micron", true, decode_report, 1);
}

TEST(Examples, TypeIsKnownForEveryAlternative) {
  EXPECT_EQ(type_of(Command{ReverseCommand{}}), 19);
  EXPECT_EQ(type_of(Report{Unknown{57}}), 57);
}

TEST(Examples, RosDriverAsksForTheDefaults) {
  EXPECT_TRUE(*decode_command(load_fixture("head_command_ros")) == Command{HeadCommand{}});
}

TEST(Examples, HalfDuplexIsByte146OfADstAndByte99OfOthers) {
  Bytes dst = load_fixture("bb_user_data");
  EXPECT_FALSE(std::get<BBUserData>(*decode_report(dst)).half_duplex());
  dst[99] = 1;
  EXPECT_FALSE(std::get<BBUserData>(*decode_report(dst)).half_duplex());
  dst[146] = 1;
  EXPECT_TRUE(std::get<BBUserData>(*decode_report(dst)).half_duplex());

  Bytes older(dst.begin(), dst.begin() + 174);
  older.push_back(frame_end);
  const auto blocks = std::get<BBUserData>(*decode_report(older));
  EXPECT_TRUE(blocks.half_duplex());
  EXPECT_EQ(encode(blocks).size(), 175U);
}

}  // namespace
}  // namespace sonard::micron::testing
