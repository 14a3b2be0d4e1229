// SPDX-License-Identifier: Apache-2.0
// The text that announces a head on Ethernet (protocol/ping360/README.md 5).
#include "protocol/ping360/discovery.hpp"

#include <gtest/gtest.h>

#include "tests/unit/protocol/ping360/codec/fixture.hpp"

namespace sonard::ping360::testing {
namespace {

Bytes bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

TEST(Ping360Discovery, Checklist7TheTextIsExactToTheByte) {
  EXPECT_EQ(discovery_reply({0x54, 0x10, 0xEC, 0x79, 0x7D, 0xC5}, 0xC0A80204),
            "SONAR PING360\r\nBlue Robotics\r\nMAC Address:- 54-10-EC-79-7D-C5\r\n"
            "IP Address:- 192.168.002.004\r\n");
}

TEST(Ping360Discovery, SmallNumbersArePadded) {
  EXPECT_EQ(discovery_reply({0, 1, 2, 0xA, 0xB, 0xFF}, 0x0A000001),
            "SONAR PING360\r\nBlue Robotics\r\nMAC Address:- 00-01-02-0A-0B-FF\r\n"
            "IP Address:- 010.000.000.001\r\n");
}

TEST(Ping360Discovery, RequestIsTheWordAndNothingElse) {
  EXPECT_TRUE(is_discovery(bytes_of("Discovery")));
  EXPECT_TRUE(is_discovery(bytes_of("Discovery\r\n")));
  EXPECT_TRUE(is_discovery(bytes_of(std::string_view(" Discovery\0", 11))));
  EXPECT_FALSE(is_discovery({}));
  EXPECT_FALSE(is_discovery(bytes_of("   ")));
  EXPECT_FALSE(is_discovery(bytes_of("discovery")));
  EXPECT_FALSE(is_discovery(bytes_of("Discovery of")));
  EXPECT_FALSE(is_discovery(bytes_of("SONAR PING360")));
  EXPECT_FALSE(is_discovery(Bytes(60'000, ' ')));
}

TEST(Ping360Discovery, AddressThatAHeadIsToldToTake) {
  EXPECT_EQ(set_ip(bytes_of("SetSS1IP 192.168.002.004")), 0xC0A80204);
  EXPECT_EQ(set_ip(bytes_of("SetSS1IP 000.000.000.000\r\n")), 0U);
  EXPECT_EQ(set_ip(bytes_of("SetSS1IP 10.1.2.3")), 0x0A010203U);
  for (const char* text : {"", "Discovery", "SetSS1IP", "SetSS1IP ", "SetSS1IP 1.2.3", "SetSS1IP 1.2.3.4.5",
                           "SetSS1IP 256.0.0.1", "SetSS1IP 1.2.3.x", "SetSS1IP 1.2.3.4 5",
                           "SetSS1IP -1.2.3.4", "SetSS1IP  1.2.3.4"}) {
    EXPECT_EQ(set_ip(bytes_of(text)), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace sonard::ping360::testing
