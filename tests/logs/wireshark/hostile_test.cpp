// SPDX-License-Identifier: Apache-2.0
// Examples with wrong bytes and cut ends: a dissector may complain, but not fail. Wireshark shows what fails
// in Lua as an expert info of its own.
#include <gtest/gtest.h>

#include <random>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/hex_fixture.hpp"

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
  const auto names = hex_fixture_names(device);
  std::mt19937 random{1};
  std::vector<pcapng::Bytes> packets;
  for (int i = 0; i < packet_count; ++i) {
    const Bytes payload = broken(load_hex_fixture(device, names[random() % names.size()]), random);
    packets.push_back(pcapng::udp_packet({0x7F000001, 50'000}, {0x7F000001, port}, payload));
  }
  int dissected = 0;
  for (const Row& row : dissect(packets, {"frame.protocols", "_ws.lua.error"})) {
    EXPECT_EQ(row.at("_ws.lua.error"), "");
    dissected += row.at("frame.protocols").find(device + "_sonar") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(dissected, packet_count);
}

TEST(HostileBytes, gemini) {
  expect_no_failure("gemini", 52'900);
}

TEST(HostileBytes, micron) {
  expect_no_failure("micron", 4002);
}

}  // namespace
}  // namespace sonard::testing
