// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/endpoint.hpp"

#include <gtest/gtest.h>

namespace sonard {
namespace {

TEST(AddressText, HasFourNumbersTheMostSignificantFirst) {
  EXPECT_EQ(address_text(0x7F000001), "127.0.0.1");
  EXPECT_EQ(address_text(0x0A3D13C8), "10.61.19.200");
  EXPECT_EQ(address_text(0), "0.0.0.0");
  EXPECT_EQ(address_text(0xFFFFFFFF), "255.255.255.255");
  EXPECT_EQ(address_text(0x01020300), "1.2.3.0");
}

TEST(EndpointText, HasThePortBehindAColon) {
  EXPECT_EQ(endpoint_text({0x7F000001, 14600}), "127.0.0.1:14600");
  EXPECT_EQ(endpoint_text({0, 0}), "0.0.0.0:0");
  EXPECT_EQ(endpoint_text({0xFFFFFFFF, 65535}), "255.255.255.255:65535");
}

}  // namespace
}  // namespace sonard
