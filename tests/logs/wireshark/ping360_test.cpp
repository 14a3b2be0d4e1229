// SPDX-License-Identifier: Apache-2.0
// The dissector of the Ping360 with streams over UDP and TCP, damaged frames, other ports, and discovery.
// Expected values are read off protocol/ping360/README.md (sections 1, 2, 5) by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string_view>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/messages.hpp"

namespace sonard::testing {
namespace {

using ::testing::HasSubstr;

const std::string prefix = "ping360_sonar.";
const std::string discovery_prefix = "ping360_discovery.";

constexpr pcapng::Endpoint client{0x7F000001, 50'000};
constexpr pcapng::Endpoint head{0x7F000002, 12'345};
constexpr pcapng::Endpoint discovery{0x7F000002, 30'303};

/// In all examples the client's number is 0, and the head's 2.
bool is_command(const Bytes& frame) {
  return frame[6] == 0;
}

pcapng::Bytes datagram_of(const Bytes& frame) {
  return is_command(frame) ? pcapng::udp_packet(client, head, frame)
                           : pcapng::udp_packet(head, client, frame);
}

Bytes text_bytes(std::string_view text) {
  return {text.begin(), text.end()};
}

void append(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// A frame with a correct checksum (1).
Bytes frame(std::uint16_t id, std::uint8_t source, const Bytes& payload) {
  const auto low = [](std::size_t value) { return static_cast<std::uint8_t>(value & 0xFFU); };
  Bytes bytes{'B', 'R', low(payload.size()), low(payload.size() >> 8), low(id), low(id >> 8), source, 0};
  append(bytes, payload);
  const unsigned sum = std::accumulate(bytes.begin(), bytes.end(), 0U);
  append(bytes, {low(sum), low(sum >> 8)});
  return bytes;
}

// If only one side sends a message, its number gives the direction; otherwise the sender's number does (1,
// 2).
TEST(Ping360Dissector, DirectionsAndRequestsInTheOlderSpelling) {
  const auto rows = dissect({datagram_of(frame(2000, 5, {5, 0})), datagram_of(frame(2601, 9, Bytes(14))),
                             datagram_of(frame(2300, 0, {})), datagram_of(frame(4, 0, {}))},
                            {prefix + "message", prefix + "from_head", prefix + "about", expert_field});
  EXPECT_EQ(rows[0].at(prefix + "message"), "set_device_id");
  EXPECT_EQ(rows[0].at(prefix + "from_head"), "1");
  EXPECT_EQ(rows[1].at(prefix + "message"), "transducer");
  EXPECT_EQ(rows[1].at(prefix + "from_head"), "0");
  EXPECT_EQ(rows[2].at(prefix + "message"), "general_request");
  EXPECT_EQ(rows[2].at(prefix + "about"), "device_data");
  EXPECT_EQ(rows[3].at(prefix + "about"), "device_information");
  for (const Row& row : rows) {
    EXPECT_EQ(row.at(expert_field), "");
  }
}

// In ping-viewer straight ahead is 200, and 400 means 0 (2.3, 6).
TEST(Ping360Dissector, StraightAheadIsAPreference) {
  Bytes settings(14);
  const auto at = [&](std::uint8_t low, std::uint8_t high) {
    settings[2] = low;
    settings[3] = high;
    return datagram_of(frame(2601, 0, settings));
  };
  const std::vector<pcapng::Bytes> packets{at(200, 0), at(201, 0), at(0x8F, 1), at(0x90, 1)};
  const auto bearings = [&](const std::vector<std::string>& options) {
    std::string all;
    for (const Row& row : dissect(packets, {prefix + "bearing_deg"}, options)) {
      all += row.at(prefix + "bearing_deg") + " ";
    }
    return all;
  };
  EXPECT_EQ(bearings({}), "180 -179.1 -0.9 0 ");
  EXPECT_EQ(bearings({"-o", "ping360_sonar.ahead:200"}), "0 0.9 179.1 180 ");
}

// ---- Streams

/// A message, and all complaints of the dissector.
const std::vector<std::string> stream_fields{
    prefix + "message",    prefix + "bad_checksum",   prefix + "malformed",
    prefix + "too_long",   prefix + "no_frame",       prefix + "unfinished",
    prefix + "unknown_id", prefix + "between_frames", "_ws.malformed"};

// A recording's serial line uses a port that the Micron's dissector has, too.
TEST(Ping360Dissector, AStreamOverTcpIsPutTogetherFromAnyPieces) {
  for (const std::size_t piece : {2000U, 50U, 3U}) {
    for (const std::uint16_t port : {std::uint16_t{12'345}, pcapng::serial_head.port}) {
      SCOPED_TRACE(std::to_string(piece) + " bytes, port " + std::to_string(port));
      const pcapng::TcpConversation line{pcapng::serial_client, {pcapng::serial_head.address, port}};
      const Row all =
          found_in(pieces_over_tcp("ping360", line, piece), stream_fields, {"-o", "ping360_sonar.tcp:12345"});
      EXPECT_EQ(all, (Row{{prefix + "message", names_in_pieces("ping360")}}));
    }
  }
}

// Datagrams contain several frames, and cut them anywhere (1.1). tshark's second pass uses the state of the
// first.
TEST(Ping360Dissector, DatagramsArePutTogetherFromAnyPieces) {
  for (const std::size_t piece : {2000U, 100U, 7U, 1U}) {
    for (const std::vector<std::string>& options : {std::vector<std::string>{}, {"-2"}}) {
      SCOPED_TRACE(std::to_string(piece) + " bytes");
      const auto packets = pieces_over_udp("ping360", client, head, piece);
      EXPECT_EQ(found_in(packets, stream_fields, options),
                (Row{{prefix + "message", names_in_pieces("ping360")}}));
    }
  }
}

TEST(Ping360Dissector, AFrameInPiecesNamesThePacketWhereItBegan) {
  const Bytes data = message_bytes("ping360", "device_data");
  std::vector<pcapng::Bytes> packets;
  for (const pcapng::ByteView bytes : pieces_of(data, 12)) {
    packets.push_back(pcapng::udp_packet(head, client, bytes));
  }
  const auto rows =
      dissect(packets, {prefix + "message", prefix + "begun_in", prefix + "piece", "_ws.col.Info"});
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].at(prefix + "piece"),
            "42521600fc08020001"
            "01c800");
  EXPECT_EQ(rows[0].at("_ws.col.Info"), "piece of a frame");
  EXPECT_EQ(rows[1].at(prefix + "begun_in"), "1");
  EXPECT_EQ(rows[2].at(prefix + "begun_in"), "1");
  EXPECT_EQ(rows[2].at(prefix + "message"), "device_data");
}

// 1.1: after 100 ms, bytes no longer complete a frame. A whole frame never completes another.
TEST(Ping360Dissector, FramesThatAreNeverFinished) {
  const Bytes data = message_bytes("ping360", "device_data");
  const auto front = pcapng::ByteView{data}.first(12);
  const auto rest = pcapng::ByteView{data}.subspan(12);
  const std::vector<std::string> fields{prefix + "message", prefix + "piece", prefix + "no_frame",
                                        prefix + "unfinished", expert_field};
  const auto late = dissect({pcapng::udp_packet(head, client, front), pcapng::udp_packet(head, client, rest)},
                            fields, {}, std::chrono::milliseconds{101});
  EXPECT_THAT(late[1].at(expert_field),
              HasSubstr("12 bytes from packet 1 on were never completed to a frame"));
  EXPECT_EQ(late[1].at(prefix + "message"), "");
  EXPECT_NE(late[1].at(prefix + "no_frame"), "");
  const auto in_time =
      dissect({pcapng::udp_packet(head, client, front), pcapng::udp_packet(head, client, rest)}, fields, {},
              std::chrono::milliseconds{99});
  EXPECT_EQ(in_time[1].at(prefix + "message"), "device_data");
  EXPECT_EQ(in_time[1].at(expert_field), "");
  const auto anew =
      dissect({pcapng::udp_packet(head, client, front), pcapng::udp_packet(head, client, data)}, fields);
  EXPECT_EQ(anew[1].at(prefix + "message"), "device_data");
  EXPECT_NE(anew[1].at(prefix + "unfinished"), "");
}

// ---- Errors, and bytes between frames

TEST(Ping360Dissector, AWrongChecksumIsSaid) {
  Bytes wrong = message_bytes("ping360", "transducer");
  wrong.at(10) = 0xC9;  // angle 201, so the sum is one more than the checksum 0x03a7
  append(wrong, message_bytes("ping360", "motor_off"));
  const auto row = dissect({datagram_of(wrong)}, {prefix + "message", prefix + "transducer.angle",
                                                  prefix + "bad_checksum", expert_field, "_ws.col.Info"})[0];
  EXPECT_EQ(row.at(prefix + "message"), "transducer,motor_off");
  EXPECT_EQ(row.at(prefix + "transducer.angle"), "201");
  EXPECT_NE(row.at(prefix + "bad_checksum"), "");
  EXPECT_EQ(row.at(expert_field), "Wrong checksum: the sum is 0x03a8");
  EXPECT_THAT(row.at("_ws.col.Info"), HasSubstr("1200 samples, wrong checksum; motor_off"));
}

// A wrong length must not hide the frames after it (1.1).
TEST(Ping360Dissector, FramesInsideOfABrokenOneAreFound) {
  Bytes bytes = message_bytes("ping360", "request_protocol_version");
  bytes.at(2) = 30;
  append(bytes, message_bytes("ping360", "motor_off"));
  append(bytes, message_bytes("ping360", "transducer"));
  append(bytes, message_bytes("ping360", "reset"));
  pcapng::TcpConversation line{pcapng::serial_client, pcapng::serial_head};
  std::vector<pcapng::Bytes> packets = line.from_client(bytes);
  packets.push_back(datagram_of(bytes));
  for (const Row& row : dissect(packets, {prefix + "message", prefix + "garbage"})) {
    EXPECT_EQ(row.at(prefix + "message"), "motor_off,transducer,reset");
    EXPECT_EQ(row.at(prefix + "garbage"), "42521e00060000000500a100");
  }
}

TEST(Ping360Dissector, JunkIsShownAndTheFrameBehindItFound) {
  const Bytes motor_off = message_bytes("ping360", "motor_off");
  Bytes behind{0x00, 0xFF, 'U', 'U', 'U', 'B'};
  append(behind, motor_off);
  const auto rows = dissect(
      {datagram_of(behind), pcapng::udp_packet(client, head, Bytes{0x00, 0xFF}),
       pcapng::udp_packet(client, head, text_bytes(std::string_view{"UUUUUUUUUU\0", 11})),
       pcapng::udp_packet(client, head, {}),
       pcapng::udp_packet({client.address, 50'001}, {client.address, 40'001}, {})},
      {prefix + "message", prefix + "garbage", prefix + "no_frame", prefix + "between_frames", expert_field});
  EXPECT_EQ(rows[0].at(prefix + "message"), "motor_off");
  EXPECT_EQ(rows[0].at(prefix + "garbage"), "00ff55555542");
  EXPECT_NE(rows[0].at(prefix + "no_frame"), "");
  for (const std::size_t i : {1U, 2U, 3U}) {
    EXPECT_EQ(rows[i].at(prefix + "no_frame"), "") << i;
    EXPECT_NE(rows[i].at(prefix + "between_frames"), "") << i;
  }
  EXPECT_THAT(rows[1].at(expert_field), HasSubstr("ping-cpp"));
  EXPECT_THAT(rows[2].at(expert_field), HasSubstr("speed of its line"));
  EXPECT_THAT(rows[3].at(expert_field), HasSubstr("Empty datagram"));
  EXPECT_EQ(rows[4].at(expert_field), "");
}

TEST(Ping360Dissector, PayloadsThatDoNotFitTheirMessage) {
  const auto rows = dissect(
      {datagram_of(frame(2601, 0, Bytes(13))), datagram_of(frame(2601, 0, Bytes(15))),
       datagram_of(frame(2300, 2, {1, 0, 0, 0, 32, 0, 80, 0, 0xE4, 2, 4, 0, 4, 0, 9, 8, 7})),
       datagram_of(frame(1, 2, {5})), datagram_of(frame(1001, 0, {}))},
      {expert_field, prefix + "malformed", prefix + "too_long", prefix + "unknown_id", prefix + "data"});
  EXPECT_NE(rows[0].at(prefix + "malformed"), "");
  EXPECT_NE(rows[1].at(prefix + "too_long"), "");
  EXPECT_THAT(rows[2].at(expert_field), HasSubstr("4 bytes of data declared, 3 present"));
  EXPECT_EQ(rows[2].at(prefix + "data"), "090807");
  EXPECT_NE(rows[3].at(prefix + "malformed"), "");
  EXPECT_NE(rows[4].at(prefix + "unknown_id"), "");
}

// ---- Ports

TEST(Ping360Dissector, FramesAreFoundOnAnyPort) {
  const Bytes request = message_bytes("ping360", "request_protocol_version");
  const pcapng::Endpoint elsewhere{0x7F000002, 40'001};
  pcapng::TcpConversation line{client, elsewhere};
  std::vector<pcapng::Bytes> packets = line.from_client(request);
  packets.push_back(pcapng::udp_packet(client, elsewhere, request));
  packets.push_back(pcapng::udp_packet(elsewhere, client, {}));
  // A wrong length for its number, an unknown number, and text that begins like a frame are not dissected.
  const pcapng::Endpoint other{0x7F000003, 40'002};
  packets.push_back(pcapng::udp_packet(client, other, frame(6, 0, {1, 2, 3})));
  packets.push_back(pcapng::udp_packet(client, other, frame(1001, 0, {})));
  packets.push_back(pcapng::udp_packet(client, other, text_bytes("BROKEN LINK")));
  const auto rows = dissect(packets, {prefix + "message", prefix + "between_frames", "frame.protocols"});
  EXPECT_EQ(rows[0].at(prefix + "message"), "general_request");
  EXPECT_EQ(rows[1].at(prefix + "message"), "general_request");
  EXPECT_NE(rows[2].at(prefix + "between_frames"), "");
  for (const std::size_t i : {3U, 4U, 5U}) {
    EXPECT_EQ(rows[i].at("frame.protocols").find("ping360"), std::string::npos) << i;
  }
}

TEST(Ping360Dissector, PortsAreAPreference) {
  const Bytes junk{0x00, 0xFF};
  const auto at = [&](std::uint16_t port) { return pcapng::udp_packet(client, {head.address, port}, junk); };
  const std::vector<pcapng::Bytes> packets{at(12'345), at(9092), at(40'001)};
  const auto found = [&](const std::vector<std::string>& options) {
    std::string ports;
    for (const Row& row : dissect(packets, {prefix + "garbage", "udp.dstport"}, options)) {
      ports += row.at(prefix + "garbage").empty() ? "" : row.at("udp.dstport") + ",";
    }
    return ports;
  };
  EXPECT_EQ(found({}), "12345,9092,");
  EXPECT_EQ(found({"-o", "ping360_sonar.udp:40000-40005"}), "40001,");
}

// ---- Discovery (5)

const std::string answer =
    "SONAR PING360  \r\nBlue Robotics\r\nMAC Address:- 54-10-EC-79-7D-C5\r\nIP Address:- 192.168.002.004\r\n";

TEST(Ping360Dissector, Discovery) {
  const auto to_head = [](std::string_view text) {
    return pcapng::udp_packet(discovery, discovery, text_bytes(text));
  };
  const auto from_head = [](std::string_view text) {
    return pcapng::udp_packet(discovery, client, text_bytes(text));
  };
  const auto rows =
      dissect({to_head("Discovery"), to_head(" Discovery\r\n"), from_head(answer),
               to_head("SetSS1IP 192.168.002.010"), from_head(answer + "Port:- 12345\r\n"),
               from_head("SONAR PING360\r\n"),
               from_head("SONAR PING360\r\nx\r\nMAC Address:- 54\r\nIP Address:- 1.2.3.400\r\n"),
               to_head("Discover")},
              {discovery_prefix + "message", discovery_prefix + "device", discovery_prefix + "maker",
               discovery_prefix + "mac_address", discovery_prefix + "ip_address", expert_field});
  EXPECT_EQ(rows[0].at(discovery_prefix + "message"), "discovery");
  EXPECT_EQ(rows[1].at(discovery_prefix + "message"), "discovery");
  EXPECT_EQ(rows[2].at(discovery_prefix + "message"), "answer");
  EXPECT_EQ(rows[2].at(discovery_prefix + "device"), "SONAR PING360  ");
  EXPECT_EQ(rows[2].at(discovery_prefix + "maker"), "Blue Robotics");
  EXPECT_EQ(rows[2].at(discovery_prefix + "mac_address"), "54:10:ec:79:7d:c5");
  EXPECT_EQ(rows[2].at(discovery_prefix + "ip_address"), "192.168.2.4");
  EXPECT_EQ(rows[3].at(discovery_prefix + "message"), "set_ip");
  EXPECT_EQ(rows[3].at(discovery_prefix + "ip_address"), "192.168.2.10");
  for (const std::size_t i : {0U, 1U, 2U, 3U, 7U}) {
    EXPECT_EQ(rows[i].at(expert_field), "") << i;
  }
  EXPECT_THAT(rows[4].at(expert_field), HasSubstr("four lines"));
  EXPECT_THAT(rows[5].at(expert_field), HasSubstr("four lines"));
  EXPECT_EQ(rows[6].at(expert_field), "No MAC address,No IP address");
  EXPECT_EQ(rows[7].at(discovery_prefix + "message"), "");
}

}  // namespace
}  // namespace sonard::testing
