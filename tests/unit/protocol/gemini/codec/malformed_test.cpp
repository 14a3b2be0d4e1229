// SPDX-License-Identifier: Apache-2.0
// Bad datagrams that a socket may receive: cut, padded, foreign and contradictory ones.
#include <gtest/gtest.h>

#include <map>
#include <span>

#include "protocol/gemini/codec.hpp"
#include "tests/support/message_fields.hpp"
#include "tests/unit/protocol/gemini/codec/fixture.hpp"

namespace sonard::gemini::testing {
namespace {

/// Length of the shortest datagram that decodes as the message, if it may be cut (sections 3.6, 3.10, 6.2).
std::size_t shortest_form(const std::string& fixture, std::size_t size) {
  static const std::map<std::string, std::size_t> shorter{
      {"network_config", 20}, {"observed_network_config", 20}, {"production_test", 20}, {"ping_head", 46}};
  const auto found = shorter.find(fixture);
  return found == shorter.end() ? size : found->second;
}

std::vector<sonard::testing::Message> examples(bool from_head) {
  auto all = sonard::testing::complete_messages("gemini");
  std::erase_if(all, [&](const auto& example) { return example.from_head != from_head; });
  return all;
}

/// A copy on the heap with exactly this length, so that sanitizers detect a read beyond it.
Bytes cut(const Bytes& bytes, std::size_t length) {
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)};
}

TEST(Malformed, CommandsCutAnywhereAreRefused) {
  for (const auto& example : examples(false)) {
    const Bytes& bytes = example.bytes;
    for (std::size_t length = 0; length < shortest_form(example.name, bytes.size()); ++length) {
      const auto decoded = decode_command(cut(bytes, length));
      ASSERT_FALSE(decoded) << example.name << " cut to " << length;
      EXPECT_EQ(decoded.error().reason, WireErrorReason::truncated) << example.name << " cut to " << length;
      EXPECT_LE(decoded.error().offset, length) << example.name;
      EXPECT_FALSE(decoded.error().field.empty()) << example.name;
    }
  }
}

TEST(Malformed, ReportsCutAnywhereAreRefused) {
  for (const auto& example : examples(true)) {
    const Bytes& bytes = example.bytes;
    for (std::size_t length = 0; length < shortest_form(example.name, bytes.size()); ++length) {
      if (example.name == "serial_data" && length >= 8 && length % 8 == 0) {
        continue;  // fewer blocks, but whole ones
      }
      ASSERT_FALSE(decode_report(cut(bytes, length))) << example.name << " cut to " << length;
    }
  }
}

TEST(Malformed, ShortFormsAreTakenAndWhatIsAbsentKeepsItsDefault) {
  const Bytes network_config = load_fixture("network_config");
  for (const std::size_t length : {20U, 21U}) {
    const auto decoded = decode_command(cut(network_config, length));
    ASSERT_TRUE(decoded) << length;
    EXPECT_EQ(std::get<NetworkConfig>(*decoded).extension, std::nullopt);
    EXPECT_EQ(std::get<NetworkConfig>(*decoded).serial_routing, 0x0100);
  }
  Bytes head = load_fixture("ping_head");
  head[46] = 3;
  for (const std::size_t length : {46U, 47U, 48U}) {
    const auto decoded = decode_report(cut(head, length));
    ASSERT_TRUE(decoded) << length;
    EXPECT_EQ(std::get<PingHead>(*decoded).decimation, length == 46 ? 0 : 3);
    EXPECT_EQ(std::get<PingHead>(*decoded).sound_speed_used, 0xBA90);
  }
  const Bytes production_test = load_fixture("production_test");
  for (std::size_t length = 20; length <= 24; ++length) {
    const auto decoded = decode_command(cut(production_test, length));
    ASSERT_TRUE(decoded) << length;
    EXPECT_EQ(std::get<ProductionTest>(*decoded).seed, 0x8102030405060708U);
  }
}

TEST(Malformed, TrailingBytesChangeNothing) {
  for (const auto& example : examples(false)) {
    if (example.name == "network_config_early") {
      continue;  // two more bytes make it the long form
    }
    Bytes bytes = example.bytes;
    for (int extra = 1; extra <= 64; ++extra) {
      bytes.push_back(0xA5);
      const auto decoded = decode_command(bytes);
      ASSERT_TRUE(decoded && *decoded == *decode_command(example.bytes))
          << example.name << " and " << extra << " bytes";
    }
  }
  for (const auto& example : examples(true)) {
    if (example.name == "serial_data") {
      continue;  // its length gives its count
    }
    Bytes bytes = example.bytes;
    for (int extra = 1; extra <= 64; ++extra) {
      bytes.push_back(0xA5);
      const auto decoded = decode_report(bytes);
      ASSERT_TRUE(decoded && *decoded == *decode_report(example.bytes))
          << example.name << " and " << extra << " bytes";
    }
  }
}

TEST(Malformed, ErrorNamesTheFirstFieldThatIsNotThere) {
  const auto decoded = decode_command(cut(load_fixture("ping_config"), 31));
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error(), (WireError{WireErrorReason::truncated, 30, "tx_angle"}));
}

TEST(Malformed, EachDirectionTakesTheOtherForUnknown) {
  for (const auto& example : examples(true)) {
    const Bytes& bytes = example.bytes;
    const auto decoded = decode_command(bytes);
    ASSERT_TRUE(decoded) << example.name;
    const auto* unknown = std::get_if<Unknown>(&*decoded);
    ASSERT_NE(unknown, nullptr) << example.name;
    EXPECT_EQ(unknown->type, bytes[0]);
    EXPECT_EQ(unknown->header.sonar_id, 601);
  }
  for (const auto& example : examples(false)) {
    const Bytes& bytes = example.bytes;
    const auto decoded = decode_report(bytes);
    ASSERT_TRUE(decoded && std::holds_alternative<Unknown>(*decoded)) << example.name;
  }
}

TEST(Malformed, ExactlyTheDocumentedTypesAreKnown) {
  const std::map<bool, std::vector<int>> documented{
      {true, {0x20, 0x21, 0x22, 0x23, 0x24, 0x25, 0x2A, 0x2B, 0x2C, 0x2D,
              0x2E, 0x2F, 0x30, 0x31, 0x32, 0x33, 0x34, 0x35, 0x36, 0xC8}},
      {false, {0x40, 0x41, 0x42, 0x43, 0x44, 0x45, 0x47, 0x48, 0x49, 0x4A, 0x4B, 0x4C, 0x4D}}};
  std::map<bool, std::vector<int>> known;
  for (int type = 0; type < 256; ++type) {
    Bytes bytes(2048, 0);
    bytes[0] = static_cast<std::uint8_t>(type);
    bytes[8] = 2;  // a valid MDIO length and a valid bank of an info block
    if (const auto command = decode_command(bytes); command && !std::holds_alternative<Unknown>(*command)) {
      EXPECT_EQ(type_of(*command), type);
      known[true].push_back(type);
    }
    if (const auto report = decode_report(bytes); report && !std::holds_alternative<Unknown>(*report)) {
      EXPECT_EQ(type_of(*report), type);
      known[false].push_back(type);
    }
  }
  EXPECT_EQ(known, documented);
}

TEST(Malformed, OddAndImpossibleMdioLengthsAreRefused) {
  for (const std::uint8_t length : {0, 1, 9, 11}) {
    Bytes bytes = load_fixture("mdio_commands");
    bytes[8] = length;
    bytes.resize(64);
    const auto decoded = decode_command(bytes);
    ASSERT_FALSE(decoded) << int{length};
    EXPECT_EQ(decoded.error(), (WireError{WireErrorReason::bad_length, 8, "length"}));
  }
  Bytes longer_than_the_datagram = load_fixture("mdio_commands");
  longer_than_the_datagram[8] = 12;
  const auto decoded = decode_command(longer_than_the_datagram);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error(), (WireError{WireErrorReason::truncated, 10, "words"}));
}

TEST(Malformed, InfoBlockBanksBeyond2AreRefused) {
  Bytes bytes = load_fixture("observed_info_block_write");
  for (const std::uint8_t bank : {3, 255}) {
    bytes[8] = bank;
    const auto decoded = decode_command(bytes);
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error(), (WireError{WireErrorReason::bad_value, 8, "bank"}));
  }
}

TEST(Malformed, ShortIdentityBlockDoesNotPassForALongBank) {
  Bytes bytes = load_fixture("info_block_write_identity");
  bytes[8] = 2;
  const auto decoded = decode_command(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error(), (WireError{WireErrorReason::truncated, 24, "filler"}));
}

TEST(Malformed, SerialDataWithABrokenBlockIsRefused) {
  Bytes bytes = load_fixture("serial_data");
  bytes.pop_back();
  const auto decoded = decode_report(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().reason, WireErrorReason::bad_length);
}

TEST(Malformed, LineDataFollowTheWordCount) {
  Bytes bytes = load_fixture("ping_line");
  bytes[14] = 0x84;  // one word more than the datagram holds
  const auto longer = decode_report(bytes);
  ASSERT_FALSE(longer);
  EXPECT_EQ(longer.error(), (WireError{WireErrorReason::truncated, 16, "data"}));
  bytes[14] = 0x84;
  bytes[15] = 0x1F;  // one word less
  const auto shorter = decode_report(bytes);
  ASSERT_TRUE(shorter);
  EXPECT_EQ(std::get<PingLine>(*shorter).data.size(), 252U);
}

}  // namespace
}  // namespace sonard::gemini::testing
