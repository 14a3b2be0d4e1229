// SPDX-License-Identifier: Apache-2.0
// Clients that may view the page and clients that may change state. docs/page.md has the rules.
#include "server/web/access.hpp"

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

constexpr Endpoint here{0x7F000001, 5000};
constexpr Endpoint elsewhere{0x0A3D130A, 5000};  // 10.61.19.10

TEST(TrustedHost, IsAnAddressOrLocalhost) {
  EXPECT_TRUE(trusted_host("127.0.0.1:8014"));
  EXPECT_TRUE(trusted_host("10.61.19.200"));
  EXPECT_TRUE(trusted_host("localhost:8014"));
}

TEST(TrustedHost, IsNoOtherName) {
  EXPECT_FALSE(trusted_host("evil.example:8014"));
  EXPECT_FALSE(trusted_host("localhost.evil.example"));
  EXPECT_FALSE(trusted_host("127.0.0.1.evil.example"));
  EXPECT_FALSE(trusted_host(""));
}

TEST(TrustedOrigin, IsThePagesOwnOrNone) {
  EXPECT_TRUE(trusted_origin("http://127.0.0.1:8014", "127.0.0.1:8014", {}));
  EXPECT_TRUE(trusted_origin("", "127.0.0.1:8014", {}));  // a client that is no browser
}

TEST(TrustedOrigin, IsNoOtherPageUnlessListed) {
  EXPECT_FALSE(trusted_origin("http://127.0.0.1:9000", "127.0.0.1:8014", {}));
  EXPECT_FALSE(trusted_origin("null", "127.0.0.1:8014", {}));
  WebConfig config;
  config.origins = {"https://viewer.example"};
  EXPECT_TRUE(trusted_origin("https://viewer.example", "127.0.0.1:8014", config));
  EXPECT_FALSE(trusted_origin("https://viewer.example.evil", "127.0.0.1:8014", config));
}

TEST(MayChange, ThisMachineMay) {
  EXPECT_TRUE(may_change(here, "", {}));
  EXPECT_FALSE(may_change(elsewhere, "", {}));
}

TEST(MayChange, WhoeverHasTheTokenMay) {
  WebConfig config;
  config.token = "secret";
  EXPECT_TRUE(may_change(elsewhere, "Bearer secret", config));
  EXPECT_FALSE(may_change(elsewhere, "Bearer secreT", config));
  EXPECT_FALSE(may_change(elsewhere, "Bearer secret1", config));
  EXPECT_FALSE(may_change(elsewhere, "secret", config));
}

TEST(MayChange, AnEmptyTokenIsNone) {
  EXPECT_FALSE(may_change(elsewhere, "Bearer ", {}));
}

}  // namespace
}  // namespace sonard::server
