// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include "server/web/json.hpp"

namespace sonard::server {
namespace {

std::string nested(int levels) {
  const auto count = static_cast<std::size_t>(levels);
  return std::string(count, '[') + std::string(count, ']');
}

TEST(JsonOfPeer, IsWhatWasSent) {
  const auto message = json_of_peer(R"({"op": "unsubscribe", "subscriptionIds": [1, 2]})");
  EXPECT_EQ(message.at("subscriptionIds").at(1), 2);
  EXPECT_FALSE(json_of_peer(nested(16)).is_discarded());
}

TEST(JsonOfPeer, IsDiscardedIfItIsNone) {
  for (const char* text : {"", "nonsense", "{\"op\": ", "[1, 2"}) {
    EXPECT_TRUE(json_of_peer(text).is_discarded()) << text;
  }
}

// 32,000 levels in 64 kB: converting such a value to text needs more than 2 MB of stack.
TEST(JsonOfPeer, IsDiscardedIfItIsNestedDeeply) {
  EXPECT_TRUE(json_of_peer(nested(18)).is_discarded());
  const std::string message =
      R"({"op": "subscribe", "subscriptions": [{"channelId": )" + nested(32'000) + "}]}";
  EXPECT_TRUE(json_of_peer(message).is_discarded());
}

}  // namespace
}  // namespace sonard::server
