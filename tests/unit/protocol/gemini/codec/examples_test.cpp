// SPDX-License-Identifier: Apache-2.0
// The messages of tests/data/gemini in both directions: bytes to values, and values to bytes.
#include <gtest/gtest.h>

#include <algorithm>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/layout.hpp"
#include "tests/support/message_fields.hpp"
#include "tests/unit/protocol/gemini/codec/fixture.hpp"

namespace sonard::gemini {

/// The last pair is first on the wire.
inline void set(MacAddress& mac, const nlohmann::json& json) {
  sonard::testing::set(mac.octets, json);
  std::ranges::reverse(mac.octets);
}

}  // namespace sonard::gemini

namespace sonard::gemini::testing {
namespace {

using sonard::testing::integer_of;
using sonard::testing::Json;
using sonard::testing::Message;
using sonard::testing::set;
using sonard::testing::take;
using sonard::testing::take_fields;

struct HeaderFields {
  static constexpr auto fields =
      std::tuple{Field{1, "version", &Header::version}, Field{2, "sonar_id", &Header::sonar_id},
                 Field{4, "packet_latency", &Header::packet_latency},
                 Field{6, "destination", &Header::destination}, Field{7, "source", &Header::source}};
};
struct IdentityFields {
  static constexpr auto fields = std::tuple{Field{16, "sonar_id", &IdentityBlock::sonar_id},
                                            Field{20, "transducer", &IdentityBlock::transducer}};
};
struct VelocimeterFields {
  static constexpr auto fields = std::tuple{Field{16, "m_coefficient", &VelocimeterBlock::m_coefficient},
                                            Field{20, "c_coefficient", &VelocimeterBlock::c_coefficient}};
};
struct AddressFields {
  static constexpr auto fields = std::tuple{Field{16, "alternate_ip", &AddressBlock::alternate_ip},
                                            Field{20, "subnet_mask", &AddressBlock::subnet_mask}};
};

// ---- The fields behind the header, for messages with a table and for others

template <HasLayout Any>
void take_body(Json& fields, const std::string& name, Any& message) {
  take_fields<Layout<Any>>(fields, name, message);
}
void take_body(Json&, const std::string&, Unknown&) {}

void take_body(Json& fields, const std::string& name, PingLine& line) {
  set(line.data, take(fields.at(name), "data"));
  take_fields<Layout<PingLine>>(fields, name, line);
}

void take_body(Json& fields, const std::string& name, InfoBlockWrite& write) {
  const Json group = take(fields, name);
  set(write.flags, group.at("flags"));
  switch (group.at("bank").get<int>()) {
    case 0:
      return take_fields<IdentityFields>(fields, name + "_identity", write.block.emplace<IdentityBlock>());
    case 1:
      return take_fields<VelocimeterFields>(fields, name + "_velocimeter",
                                            write.block.emplace<VelocimeterBlock>());
    case 2:
      return take_fields<AddressFields>(fields, name + "_address", write.block.emplace<AddressBlock>());
    default:
      FAIL() << "no bank " << group.at("bank");
  }
}

void take_body(Json& fields, const std::string& name, SerialTransmit& serial) {
  const Json group = take(fields, name);
  set(serial.data, group.at("data"));
  EXPECT_EQ(group.at("length"), serial.data.size());
}

void take_body(Json& fields, const std::string& name, MdioCommands& commands) {
  const Json group = take(fields, name);
  set(commands.words, group.at("word"));
  EXPECT_EQ(group.at("length"), 2 + 2 * commands.words.size());
}

void take_body(Json& fields, const std::string& name, SerialData& serial) {
  const Json group = take(fields, name);
  for (std::size_t i = 0; i < group.at("time_us").size(); ++i) {
    SerialByte& byte = serial.bytes.emplace_back();
    set(byte.time_us, group.at("time_us")[i]);
    set(byte.value, group.at("value").at(i));
  }
}

// ---- Both directions

class GeminiMessage : public ::testing::TestWithParam<Message> {};

TEST_P(GeminiMessage, BytesAndFieldsMeanTheSame) {
  const Message& example = GetParam();
  const auto check = [&](const auto& decoded) {
    ASSERT_TRUE(decoded) << to_string(decoded.error());
    const auto described = expect_fields(example, *decoded, [&](Json& fields, auto& message) {
      EXPECT_EQ(type_of(*decoded), integer_of(take(fields.at("header"), "type")));
      take_fields<HeaderFields>(fields, "header", message.header);
      take_body(fields, example.message, message);
    });
    if (example.is_written) {
      EXPECT_EQ(encode(described), example.bytes);
    }
  };
  example.from_head ? check(decode_report(example.bytes)) : check(decode_command(example.bytes));
}
INSTANTIATE_TEST_SUITE_P(all, GeminiMessage,
                         ::testing::ValuesIn(sonard::testing::complete_messages("gemini")),
                         sonard::testing::message_name);

TEST(Examples, CoverEveryMessageOfBothDirections) {
  // All but Unknown, which is no message.
  sonard::testing::expect_every_alternative<Command>("gemini", false, decode_command, 1);
  sonard::testing::expect_every_alternative<Report>("gemini", true, decode_report, 1);
}

TEST(Examples, LastAndResentLinesDifferFromTheFirstInTwoFields) {
  const Bytes first = load_fixture("ping_line");
  PingLine line = std::get<PingLine>(*decode_report(first));
  line.line_id = 482;
  line.line_info = make_line_info(line.data.size(), true, 0x0204);
  Bytes start = encode(line);
  start.resize(16);
  EXPECT_EQ(start, load_fixture("ping_line_last_start"));

  line.line_id = resent_line | 10;
  line.line_info = make_line_info(line.data.size(), false, 0x0204);
  start = encode(line);
  start.resize(16);
  EXPECT_EQ(start, load_fixture("ping_line_resent_start"));
}

TEST(Examples, HeaderIsReadableWithoutTheRest) {
  const auto header = decode_header(load_fixture("observed_ping_config_mk2"));
  ASSERT_TRUE(header);
  EXPECT_EQ(*header, (Header{.sonar_id = 1234, .version = 1, .destination = 0x1E, .source = 1}));
}

TEST(Examples, AppendingKeepsWhatIsThere) {
  Bytes out{0xAA};
  encode(PingTail{Header{.sonar_id = 601}, 5, 0}, out);
  Bytes expected{0xAA};
  const Bytes tail = load_fixture("ping_tail");
  expected.insert(expected.end(), tail.begin(), tail.end());
  EXPECT_EQ(out, expected);
}

TEST(Examples, TypeAndHeaderAreKnownForEveryAlternative) {
  EXPECT_EQ(type_of(Command{GoingOffline{}}), 0xC8);
  EXPECT_EQ(type_of(Report{PingLine{}}), 0x42);
  EXPECT_EQ(type_of(Report{Unknown{Header{}, 0x46}}), 0x46);
  EXPECT_EQ(header_of(Command{Reboot{Header{.sonar_id = 7}, 1}}).sonar_id, 7);
  EXPECT_EQ(header_of(Report{Diagnostic{Header{.sonar_id = 8}}}).sonar_id, 8);
}

}  // namespace
}  // namespace sonard::gemini::testing
