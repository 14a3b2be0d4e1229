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
  EXPECT_EQ(parse_own_address("10.61.19.200")->address, 0x0A3D13C8u);
  EXPECT_EQ(parse_own_address("10.61.19.200")->interface, "");
  EXPECT_EQ(parse_own_netmask("255.255.255.0")->netmask, 0xFFFFFF00u);
  EXPECT_EQ(parse_own_address("lo")->address, 0x7F000001u);
  EXPECT_EQ(parse_own_address("lo")->interface, "lo");
  EXPECT_EQ(parse_own_address("lo")->trouble, "");
  EXPECT_EQ(parse_own_netmask("lo")->netmask, 0xFF000000u);
}

TEST(Interfaces, WhatIsNeitherAddressNorNameIsNotUnderstood) {
  for (const char* text : {"", "no such interface", "127.0.0.300", "10.1", "eth0/24", "fe80::1", "eth0:1",
                           "a_name_that_is_too_long"}) {
    EXPECT_FALSE(parse_own_address(text)) << text;
    EXPECT_FALSE(parse_own_netmask(text)) << text;
  }
}

TEST(Interfaces, ANameThatThisMachineDoesNotHaveMayComeLater) {
  for (const auto& own : {parse_own_address("usb77"), parse_own_netmask("usb77")}) {
    ASSERT_TRUE(own);
    EXPECT_EQ(own->address + own->netmask, 0u);
    EXPECT_EQ(own->trouble.find("there is no interface 'usb77' (yet); this machine has "), 0u)
        << own->trouble;
    EXPECT_NE(own->trouble.find("lo"), std::string::npos) << own->trouble;
  }
}

constexpr Ipv4 first = 0x0A3D13C8, second = 0xC0A802C8, other = 0x0A3D13C9;

TEST(Followed, IsTheFirstAddressOfTheInterfaceWhereTheOldOneIsGone) {
  ASSERT_TRUE(followed("eth0", other, interfaces));
  EXPECT_EQ(followed("eth0", other, interfaces)->address, first);
  EXPECT_EQ(followed("eth0", other, interfaces)->netmask, 0xFFFFFF00u);
}

TEST(Followed, IsNoneAsLongAsTheInterfaceHasTheAddressOrNoneAtAll) {
  EXPECT_FALSE(followed("eth0", first, interfaces));
  EXPECT_FALSE(followed("eth0", second, interfaces)) << "its second one";
  EXPECT_FALSE(followed("eth1", first, interfaces));
  EXPECT_FALSE(followed("eth0", first, {}));
}

TEST(Followed, IsNoneOfAHeadThatIsNamedByItsAddress) {
  EXPECT_FALSE(followed("", other, interfaces));
}

TEST(OwnAddresses, AreToldOnceWhenTheyGoAndWhenTheyAreBack) {
  OwnAddresses own;
  const std::vector<InterfaceAddress> without{interfaces[0], interfaces[2]};
  EXPECT_TRUE(own.look({first, second}, interfaces).gone.empty());
  EXPECT_EQ(own.look({first, second}, without).gone, std::vector{first});
  EXPECT_TRUE(own.look({first, second}, without).gone.empty()) << "told already";
  EXPECT_EQ(own.gone(), std::set{first});
  EXPECT_EQ(own.look({first, second}, interfaces).back, std::vector{first});
  EXPECT_TRUE(own.gone().empty());
  EXPECT_EQ(own.look({first, second}, without).gone, std::vector{first}) << "each time";
}

TEST(OwnAddresses, ThatWereNeverHereAreNotGone) {
  OwnAddresses own;
  EXPECT_TRUE(own.look({other, 0}, interfaces).gone.empty());
  EXPECT_TRUE(own.gone().empty());
}

TEST(OwnAddresses, WhatIsServedNoMoreIsForgotten) {
  OwnAddresses own;
  own.look({first}, interfaces);
  own.look({first}, {interfaces[0]});
  EXPECT_TRUE(own.look({second}, {interfaces[0], interfaces[2]}).back.empty());
  EXPECT_TRUE(own.gone().empty());
}

TEST(OwnAddresses, NothingChangesWhereTheSystemDoesNotTell) {
  OwnAddresses own;
  own.look({first}, interfaces);
  EXPECT_TRUE(own.look({first}, {}).gone.empty());
}

}  // namespace
}  // namespace sonard::server
