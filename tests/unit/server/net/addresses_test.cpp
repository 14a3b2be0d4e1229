// SPDX-License-Identifier: Apache-2.0
#include "server/net/addresses.hpp"

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

TEST(Ipv4Text, IsReadFirstOctetMostSignificant) {
  EXPECT_EQ(parse_ipv4("10.61.19.200"), 0x0A3D13C8U);
  EXPECT_EQ(parse_ipv4("0.0.0.0"), 0U);
  EXPECT_EQ(parse_ipv4("255.255.255.255"), 0xFFFFFFFFU);
  EXPECT_EQ(address_text(0x0A3D13C8), "10.61.19.200");
}

TEST(Ipv4Text, RefusesEverythingElse) {
  for (const char* text : {"", "1.2.3", "1.2.3.4.5", "1.2.3.256", "1.2.3.-4", "1.2.3. 4", "01.2.3.4",
                           "1..3.4", "a.b.c.d", "1.2.3.4 ", "localhost", "::1", "1.2.3.99999999999"}) {
    EXPECT_FALSE(parse_ipv4(text)) << '"' << text << '"';
  }
}

TEST(CidrText, IsANetworkAndALength) {
  EXPECT_EQ(parse_cidr("127.0.0.0/8"), (Cidr{0x7F000000, 8}));
  EXPECT_EQ(parse_cidr("0.0.0.0/0"), (Cidr{0, 0}));
  EXPECT_EQ(parse_cidr("10.61.19.1"), (Cidr{0x0A3D1301, 32}));
  EXPECT_EQ(cidr_text({0x0A3D1300, 24}), "10.61.19.0/24");
  for (const char* text : {"127.0.0.1/8", "10.0.0.0/33", "10.0.0.0/", "10.0.0.0/-1", "/8", "10.0.0/8"}) {
    EXPECT_FALSE(parse_cidr(text)) << '"' << text << '"';
  }
}

TEST(CidrText, ContainsExactlyItsAddresses) {
  const Cidr block{0x0A3D1300, 24};
  EXPECT_TRUE(block.contains(0x0A3D1300));
  EXPECT_TRUE(block.contains(0x0A3D13FF));
  EXPECT_FALSE(block.contains(0x0A3D1400));
  EXPECT_FALSE(block.contains(0x0A3D12FF));
  EXPECT_TRUE((Cidr{0, 0}.contains(0xFFFFFFFF)));
  EXPECT_TRUE((Cidr{5, 32}.contains(5)));
  EXPECT_FALSE((Cidr{5, 32}.contains(4)));
}

TEST(AllowList, NeedsOneBlockThatContainsTheAddress) {
  const AllowList list{{0x7F000000, 8}, {0x0A3D1300, 24}};
  EXPECT_TRUE(allows(list, 0x7F123456));
  EXPECT_TRUE(allows(list, 0x0A3D1301));
  EXPECT_FALSE(allows(list, 0x08080808));
  EXPECT_FALSE(allows({}, 0x7F000001));
}

TEST(EndpointText, IsAnAddressAndAPort) {
  EXPECT_EQ(parse_endpoint("127.0.0.1:14600"), (Endpoint{0x7F000001, 14600}));
  EXPECT_EQ(endpoint_text({0x7F000001, 14600}), "127.0.0.1:14600");
  for (const char* text :
       {"127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", ":14600", "127.0.0.1:1:2", "localhost:80"}) {
    EXPECT_FALSE(parse_endpoint(text)) << '"' << text << '"';
  }
}

TEST(MacText, IsSixOctets) {
  EXPECT_EQ(parse_mac("00:12:34:aB:02:ff"),
            (std::array<std::uint8_t, 6>{0x00, 0x12, 0x34, 0xAB, 0x02, 0xFF}));
  for (const char* text : {"", "00:12:34:00:02", "00:12:34:00:02:1", "00:12:34:00:02:01:03",
                           "00-12-34-00-02-01", "0g:12:34:00:02:01"}) {
    EXPECT_FALSE(parse_mac(text)) << '"' << text << '"';
  }
}

TEST(Netmask, HasLeadingOnesOnly) {
  EXPECT_EQ(prefix_length_of(0xFFFFFF00), 24);
  EXPECT_EQ(prefix_length_of(0xFF000000), 8);
  EXPECT_EQ(prefix_length_of(0xFFFFFFFF), 32);
  EXPECT_EQ(prefix_length_of(0), 0);
  EXPECT_FALSE(prefix_length_of(0xFFFF00FF));
  EXPECT_FALSE(prefix_length_of(0x000000FF));
  EXPECT_EQ(netmask_of(0), 0U);
  EXPECT_EQ(netmask_of(8), 0xFF000000U);
  EXPECT_EQ(netmask_of(32), 0xFFFFFFFFU);
}

}  // namespace
}  // namespace sonard::server
