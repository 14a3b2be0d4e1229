// SPDX-License-Identifier: Apache-2.0
// The dissector of the Gemini with cut messages, lines that do not fit their ping, and other ports.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/messages.hpp"

namespace sonard::testing {
namespace {

using ::testing::HasSubstr;

const std::string prefix = "gemini_sonar.";

bool is_command(const Bytes& datagram) {
  return datagram[0] < 0x40 || datagram[0] == 0xC8;
}

pcapng::Bytes packet_of(const Bytes& datagram) {
  return is_command(datagram) ? to_head(datagram) : from_head(datagram);
}

// The header alone is complete for status requests only, and half a header never is.
TEST(GeminiDissector, EveryExampleCutShortIsShownAsMalformed) {
  std::vector<pcapng::Bytes> packets;
  std::vector<std::string> names;
  for (const std::string& name : message_names("gemini")) {
    const Bytes whole = message_bytes("gemini", name);
    const bool is_header = name == "status_request" || name == "observed_status_request";
    for (const std::ptrdiff_t size : {1, 7, is_header ? 7 : 9}) {
      packets.push_back(packet_of(Bytes{whole.begin(), whole.begin() + size}));
      names.push_back(name + " of " + std::to_string(size));
    }
  }
  const auto rows = dissect(packets, {prefix + "malformed", prefix + "bad_value"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NE(rows[i].at(prefix + "malformed") + rows[i].at(prefix + "bad_value"), "") << names[i];
  }
}

Bytes with(Bytes bytes, std::size_t offset, std::uint8_t value) {
  bytes.at(offset) = value;
  return bytes;
}

// A run-length coded ping of two lines (6.8): 00 c is c zeros, 01 one zero.
TEST(GeminiDissector, LinesAreHeldToTheHeadOfTheirPing) {
  Bytes head = with(with(message_bytes("gemini", "ping_head"), 22, 2), 23, 0);
  head = with(head, 44, 50);                                                      // threshold
  const Bytes good{0x42, 1,   0x59, 2, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0x04, 0x02,  // 4 words
                   0,    255, 200,  0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,    0};
  Bytes few = with(good, 17, 100);
  few = with(few, 10, 1);
  const Bytes beyond = with(good, 10, 2);
  const auto rows = dissect({from_head(head), from_head(good), from_head(few), from_head(beyond)},
                            {prefix + "ping_line.head_frame", prefix + "ping_line.beams_coded",
                             prefix + "ping_line.data_length", expert_field, "_ws.col.Info"});
  EXPECT_EQ(rows[1].at(prefix + "ping_line.head_frame"), "1");
  EXPECT_EQ(rows[1].at(prefix + "ping_line.beams_coded"), "256");
  EXPECT_EQ(rows[1].at(prefix + "ping_line.data_length"), "16");
  EXPECT_EQ(rows[1].at(expert_field), "");
  EXPECT_THAT(rows[1].at("_ws.col.Info"), HasSubstr("line 0 of 2"));
  EXPECT_EQ(rows[2].at(prefix + "ping_line.beams_coded"), "101");
  EXPECT_THAT(rows[2].at(expert_field), HasSubstr("101 beams of 256"));
  EXPECT_THAT(rows[3].at(expert_field), HasSubstr("Line 2 of 2"));
}

TEST(GeminiDissector, PortsAreAPreference) {
  const Bytes status = message_bytes("gemini", "status");
  const pcapng::Bytes elsewhere = pcapng::udp_packet({0x7F000001, 40'000}, {0x7F000001, 40'001}, status);
  EXPECT_EQ(dissect({elsewhere}, {prefix + "message"})[0].at(prefix + "message"), "");
  EXPECT_EQ(dissect({elsewhere}, {prefix + "message"}, {"-o", "gemini_sonar.ports:40001"})[0].at(prefix +
                                                                                                 "message"),
            "status");
}

}  // namespace
}  // namespace sonard::testing
