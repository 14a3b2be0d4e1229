// SPDX-License-Identifier: Apache-2.0
// The dissector of the Oculus with streams, bytes between messages, and sizes that do not fit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/message_fields.hpp"

namespace sonard::testing {
namespace {

using ::testing::HasSubstr;

const std::string prefix = "oculus_sonar.";
constexpr pcapng::Endpoint head{0xC0A80204, 52'100};
constexpr pcapng::Endpoint client{0xC0A80205, 40'000};

const std::vector<std::string> reports{"ping_result_v1", "ping_result_v2", "dummy", "user_config"};

TEST(OculusDissector, AStreamIsPutTogetherFromAnyPieces) {
  Bytes stream;
  std::string names;
  for (const std::string& name : reports) {
    const Message& report = message_of("oculus", name);
    stream.insert(stream.end(), report.bytes.begin(), report.bytes.end());
    names += report.message + ",";
  }
  for (const std::size_t piece : {2000U, 50U, 3U}) {
    SCOPED_TRACE(piece);
    pcapng::TcpConversation line{client, head};
    std::vector<pcapng::Bytes> packets = line.open();
    for (const pcapng::ByteView bytes : pieces_of(stream, piece)) {
      const auto sent = line.from_server(bytes);
      packets.insert(packets.end(), sent.begin(), sent.end());
    }
    EXPECT_EQ(found_in(packets, {prefix + "message", prefix + "malformed", prefix + "no_message"}),
              (Row{{prefix + "message", names}}));
  }
}

TEST(OculusDissector, GarbageAndSizesThatDoNotFitAreShown) {
  Bytes bytes{'S', 'x', 'O'};
  Bytes ping = message_bytes("oculus", "ping_result_v1");
  ping.at(106) = 2;  // rows
  bytes.insert(bytes.end(), ping.begin(), ping.end());
  pcapng::TcpConversation line{client, head};
  const Row row = dissect(line.from_server(bytes), {prefix + "message", prefix + "garbage", expert_field})[0];
  EXPECT_EQ(row.at(prefix + "message"), "simple_ping_result");
  EXPECT_EQ(row.at(prefix + "garbage"), "53784f");
  EXPECT_THAT(row.at(expert_field), HasSubstr("belong to no message"));
  EXPECT_THAT(row.at(expert_field), HasSubstr("do not fit each other"));
}

}  // namespace
}  // namespace sonard::testing
