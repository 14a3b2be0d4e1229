// SPDX-License-Identifier: Apache-2.0
// Examples with wrong bytes and cut ends: a dissector may warn, but not fail. Wireshark shows a failure in
// Lua as an expert info of its own.
#include <gtest/gtest.h>

#include <random>
#include <string_view>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/messages.hpp"

namespace sonard::testing {
namespace {

constexpr int packet_count = 2000;

Bytes broken(Bytes bytes, std::mt19937& random) {
  for (unsigned changes = random() % 6; changes > 0; --changes) {
    bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
  }
  if (random() % 2 == 0) {
    bytes.resize(1 + random() % bytes.size());
  }
  return bytes;
}

void expect_no_failure(const std::string& device, std::uint16_t port) {
  const auto names = message_names(device);
  std::mt19937 random{1};
  std::vector<pcapng::Bytes> packets;
  for (int i = 0; i < packet_count; ++i) {
    const Bytes payload = broken(message_bytes(device, names[random() % names.size()]), random);
    packets.push_back(pcapng::udp_packet({0x7F000001, 50'000}, {0x7F000001, port}, payload));
  }
  int dissected = 0;
  for (const Row& row : dissect(packets, {"frame.protocols", "_ws.lua.error"})) {
    EXPECT_EQ(row.at("_ws.lua.error"), "");
    dissected += row.at("frame.protocols").find(device + "_sonar") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(dissected, packet_count);
}

TEST(HostileBytes, DvlA50) {
  expect_no_failure("dvl_a50", 16'171);
}

TEST(HostileBytes, Gemini) {
  expect_no_failure("gemini", 52'900);
}

TEST(HostileBytes, Micron) {
  expect_no_failure("micron", 4002);
}

TEST(HostileBytes, Oculus) {
  expect_no_failure("oculus", 52'102);
}

TEST(HostileBytes, Ping1d) {
  expect_no_failure("ping1d", 9090);
}

TEST(HostileBytes, Ping360) {
  expect_no_failure("ping360", 12'345);
}

void expect_no_failure(const std::vector<pcapng::Bytes>& packets) {
  for (const Row& row : dissect(packets, {"_ws.lua.error"})) {
    EXPECT_EQ(row.at("_ws.lua.error"), "");
  }
}

// Consecutive broken frames in datagrams that cut them anywhere.
TEST(HostileBytes, Ping360Stream) {
  const auto names = message_names("ping360");
  std::mt19937 random{2};
  std::vector<pcapng::Bytes> packets;
  for (int i = 0; i < packet_count; ++i) {
    Bytes payload;
    for (unsigned frames = 1 + random() % 4; frames > 0; --frames) {
      const Bytes frame = broken(message_bytes("ping360", names[random() % names.size()]), random);
      payload.insert(payload.end(), frame.begin(), frame.end());
    }
    packets.push_back(pcapng::udp_packet({0x7F000001, 50'000}, {0x7F000001, 9092}, payload));
  }
  expect_no_failure(packets);
}

// The same kind of broken messages in one stream, which Wireshark reassembles.
TEST(HostileBytes, OculusStream) {
  const auto names = message_names("oculus");
  std::mt19937 random{3};
  pcapng::TcpConversation line{{0x7F000001, 50'000}, {0x7F000001, 52'100}};
  std::vector<pcapng::Bytes> packets;
  for (int i = 0; i < packet_count; ++i) {
    const Bytes message = broken(message_bytes("oculus", names[random() % names.size()]), random);
    const auto sent = random() % 2 == 0 ? line.from_server(message) : line.from_client(message);
    packets.insert(packets.end(), sent.begin(), sent.end());
  }
  expect_no_failure(packets);
}

// Every four bytes begin a frame of the longest payload with a wrong checksum. tshark must finish within its
// time limit.
TEST(HostileBytes, Ping360FramesWithinFrames) {
  Bytes payload;
  while (payload.size() + 4 <= pcapng::max_udp_payload) {
    payload.insert(payload.end(), {'B', 'R', 0x00, 0x10});
  }
  expect_no_failure(
      std::vector<pcapng::Bytes>(20, pcapng::udp_packet({0x7F000001, 50'000}, {0x7F000001, 9092}, payload)));
}

TEST(HostileBytes, Ping360Discovery) {
  const std::string_view answer =
      "SONAR PING360\r\nBlue Robotics\r\nMAC Address:- 54-10-EC-79-7D-C5\r\nIP Address:- 192.168.002.004\r\n";
  std::mt19937 random{3};
  std::vector<pcapng::Bytes> packets;
  for (int i = 0; i < packet_count; ++i) {
    const std::string_view text = i % 3 == 0 ? "Discovery" : i % 3 == 1 ? "SetSS1IP 192.168.002.004" : answer;
    const Bytes payload = broken({text.begin(), text.end()}, random);
    packets.push_back(pcapng::udp_packet({0x7F000001, 30'303}, {0x7F000001, 30'303}, payload));
  }
  expect_no_failure(packets);
}

}  // namespace
}  // namespace sonard::testing
