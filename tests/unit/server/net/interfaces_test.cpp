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

constexpr Ipv4 mask = 0xFFFFFF00, wide_mask = 0xFFFF0000;

TEST(Followed, IsTheFirstAddressOfTheInterfaceIfTheOldOneIsGone) {
  const auto found = followed("eth0", "eth0", {"", other, wide_mask}, interfaces);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->interface, "eth0");
  EXPECT_EQ(found->address, first);
  EXPECT_EQ(found->netmask, mask);
  EXPECT_EQ(followed("eth0", "", {"", other, wide_mask}, interfaces)->netmask, wide_mask)
      << "given as numbers";
}

TEST(Followed, IsTheMaskIfItAloneChanges) {
  const std::vector<InterfaceAddress> now{{"eth0", second, mask}, {"eth0", first, wide_mask}};
  const auto found = followed("eth0", "eth0", {"", first, mask}, now);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->address, first);
  EXPECT_EQ(found->netmask, wide_mask) << "that of its own address, not of the first";
  EXPECT_EQ(followed("", "eth0", {"", first, mask}, now)->netmask, wide_mask)
      << "the address is given as numbers";
  EXPECT_FALSE(followed("eth0", "", {"", first, mask}, now));
}

TEST(Followed, IsNoneAsLongAsTheInterfaceHasTheAddressOrNoneAtAll) {
  EXPECT_FALSE(followed("eth0", "eth0", {"", first, mask}, interfaces));
  EXPECT_FALSE(followed("eth0", "eth0", {"", second, mask}, interfaces)) << "its second one";
  EXPECT_FALSE(followed("eth1", "eth1", {"", first, mask}, interfaces));
  EXPECT_FALSE(followed("eth0", "eth0", {"", first, mask}, {}));
}

TEST(Followed, IsNoneOfAHeadThatIsNamedByItsAddress) {
  EXPECT_FALSE(followed("", "", {"", other, mask}, interfaces));
}

TEST(Followed, TextNamesWhatChanged) {
  const InterfaceAddress before{"", other, mask};
  EXPECT_EQ(followed_text(before, {"eth0", first, mask}), "eth0: its address is 10.61.19.200 now");
  EXPECT_EQ(followed_text(before, {"eth0", other, wide_mask}), "eth0: its netmask is 255.255.0.0 now");
  EXPECT_EQ(followed_text(before, {"eth0", first, wide_mask}),
            "eth0: its address is 10.61.19.200 now, its netmask is 255.255.0.0 now");
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
