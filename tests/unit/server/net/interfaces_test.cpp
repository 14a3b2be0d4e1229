// SPDX-License-Identifier: Apache-2.0
#include "server/net/interfaces.hpp"

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

const std::vector<InterfaceAddress> interfaces{
    {"lo", 0x7F000001, 0xFF000000},    // 127.0.0.1/8
    {"eth0", 0x0A3D13C8, 0xFFFFFF00},  // 10.61.19.200/24
    {"eth0", 0xC0A802C8, 0xFFFFFF00},  // 192.168.2.200/24
};

TEST(Interfaces, OwnerIsTheInterfaceWithThatAddress) {
  ASSERT_TRUE(owner_of(0xC0A802C8, interfaces));
  EXPECT_EQ(owner_of(0xC0A802C8, interfaces)->interface, "eth0");
  EXPECT_EQ(owner_of(0xC0A802C8, interfaces)->address, 0xC0A802C8u);
}

TEST(Interfaces, NeighbourOnTheSameNetworkIsNotOurs) {
  EXPECT_FALSE(owner_of(0x0A3D130A, interfaces));
}

TEST(Interfaces, AllOfLoopbackIsOurs) {
  ASSERT_TRUE(owner_of(0x7F000002, interfaces));
  EXPECT_EQ(owner_of(0x7F000002, interfaces)->netmask, 0xFF000000u);
}

TEST(Interfaces, ThisMachineHasLoopback) {
  EXPECT_TRUE(owner_of(0x7F000001, interface_addresses()));
}

TEST(Interfaces, ANameStandsForTheFirstAddress) {
  EXPECT_EQ(parse_own_address("10.61.19.200"), 0x0A3D13C8u);
  EXPECT_EQ(parse_own_netmask("255.255.255.0"), 0xFFFFFF00u);
  EXPECT_EQ(parse_own_address("lo"), 0x7F000001u);
  EXPECT_EQ(parse_own_netmask("lo"), 0xFF000000u);
  EXPECT_FALSE(parse_own_address("no such interface"));
  EXPECT_FALSE(parse_own_netmask(""));
}

}  // namespace
}  // namespace sonard::server
