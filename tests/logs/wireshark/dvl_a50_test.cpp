// SPDX-License-Identifier: Apache-2.0
// The dissector of the DVL with streams: objects with and without line ends, bytes between messages, and
// wrong checksums.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string_view>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/message_fields.hpp"

namespace sonard::testing {
namespace {

using ::testing::HasSubstr;

const std::string prefix = "dvl_a50_sonar.";
constexpr pcapng::Endpoint client{0xC0A80205, 40'000};

pcapng::Endpoint device(std::uint16_t port) {
  return {0xC0A8025F, port};
}

Bytes joined(std::initializer_list<std::string_view> texts) {
  Bytes all;
  for (const std::string_view text : texts) {
    all.insert(all.end(), text.begin(), text.end());
  }
  return all;
}

/// The packets of a stream in pieces of `piece` bytes.
std::vector<pcapng::Bytes> stream_of(std::uint16_t port, const Bytes& bytes, std::size_t piece,
                                     bool from_head) {
  pcapng::TcpConversation line{client, device(port)};
  std::vector<pcapng::Bytes> packets = line.open();
  for (const pcapng::ByteView part : pieces_of(bytes, piece)) {
    const auto sent = from_head ? line.from_server(part) : line.from_client(part);
    packets.insert(packets.end(), sent.begin(), sent.end());
  }
  return packets;
}

Row names_in(const std::vector<pcapng::Bytes>& packets) {
  return found_in(packets, {prefix + "message", prefix + "no_message", prefix + "bad_checksum"});
}

TEST(DvlDissector, ObjectsArePutTogetherFromAnyPieces) {
  const Bytes commands =
      joined({R"({"command":"get_config"}{"command":"set_config","parameters":{"range_mode":"}{"}})", "\r\n ",
              R"({"command":"a\"}"})"});
  const Bytes velocity = message_bytes("dvl_a50", "velocity");
  Bytes reports = velocity;
  for (const std::string_view text : {"\r\n", "\n"}) {
    reports.insert(reports.end(), text.begin(), text.end());
    reports.insert(reports.end(), velocity.begin(), velocity.end());
  }
  for (const std::size_t piece : {2000U, 50U, 7U}) {
    SCOPED_TRACE(piece);
    EXPECT_EQ(names_in(stream_of(16'171, commands, piece, false)),
              (Row{{prefix + "message", "get_config,set_config,a\\,"}}));
    EXPECT_EQ(names_in(stream_of(16'171, reports, piece, true)),
              (Row{{prefix + "message", "velocity,velocity,velocity,"}}));
  }
}

TEST(DvlDissector, Pd6AndPd4AreStreamsToo) {
  for (const auto& [name, port] :
       {std::pair{"pd6", std::uint16_t{1037}}, std::pair{"pd4", std::uint16_t{1038}}}) {
    const Bytes message = message_bytes("dvl_a50", name);
    Bytes twice = message;
    twice.insert(twice.end(), message.begin(), message.end());
    EXPECT_EQ(names_in(stream_of(port, twice, 10, true)),
              (Row{{prefix + "message", std::string(name) + "," + name + ","}}));
  }
}

TEST(DvlDissector, WrongChecksumsAndBytesBetweenMessagesAreShown) {
  Bytes pd4 = message_bytes("dvl_a50", "pd4");
  pd4.at(5) ^= 1;
  const std::vector<std::string> fields{prefix + "message", prefix + "garbage", expert_field};
  const auto datagram = [](const Bytes& bytes) { return pcapng::udp_packet(device(16'171), client, bytes); };
  const auto rows =
      dissect({datagram(pd4), datagram(joined({"wcc*96\r\n"})), datagram(joined({"ok{}"}))}, fields);
  EXPECT_EQ(rows[0].at(prefix + "message"), "pd4");
  EXPECT_THAT(rows[0].at(expert_field), HasSubstr("Wrong checksum"));
  EXPECT_EQ(rows[1].at(prefix + "message"), "sentence");
  EXPECT_THAT(rows[1].at(expert_field), HasSubstr("Wrong checksum"));
  EXPECT_EQ(rows[2].at(prefix + "garbage"), "6f6b");
  EXPECT_THAT(rows[2].at(expert_field), HasSubstr("belong to no message"));
}

}  // namespace
}  // namespace sonard::testing
