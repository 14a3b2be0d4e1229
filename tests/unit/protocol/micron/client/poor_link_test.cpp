// SPDX-License-Identifier: Apache-2.0
// A client and a head on a line that splits frames, adds noise and loses frames.
#include <random>

#include "session.hpp"

namespace sonard::micron {
namespace {

/// Cuts frames into pieces, adds noise before some frames and loses some.
Session::Carrier poor_carrier(std::mt19937& random, unsigned lost_percent) {
  return [&random, lost_percent](const Bytes& frame) {
    std::vector<Bytes> pieces;
    if (random() % 100 < lost_percent) {
      return pieces;
    }
    if (random() % 4 == 0) {
      Bytes& noise = pieces.emplace_back(random() % 9);
      std::ranges::generate(noise,
                            [&] { return static_cast<std::uint8_t>(random() % 3 == 0 ? '@' : random()); });
    }
    const std::size_t cut = random() % frame.size();
    pieces.emplace_back(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(cut));
    pieces.emplace_back(frame.begin() + static_cast<std::ptrdiff_t>(cut), frame.end());
    return pieces;
  };
}

TEST(PoorLink, SplitAndNoisyLineLosesNothing) {
  std::mt19937 random(3);
  Session session;
  session.to_head = poor_carrier(random, 0);
  session.to_client = poor_carrier(random, 0);
  session.client.start(0ns, all_round(), 200);
  session.run_to_end();
  ASSERT_EQ(session.lines.size(), 200U);
  for (std::size_t i = 0; i < 200; ++i) {
    EXPECT_EQ(session.lines[i].head.bearing, (3200 + 32 * static_cast<int>(i)) % 6400);
  }
  EXPECT_EQ(session.client.statistics().timeouts, 0U);
  EXPECT_GT(session.client.statistics().dropped_bytes, 0U);
}

TEST(PoorLink, LostFramesCostTimeOnly) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    DeviceConfig config;
    config.half_duplex = seed % 2 == 0;
    Session session(config);
    session.to_head = poor_carrier(random, 10);
    session.to_client = poor_carrier(random, 10);
    session.client.start(0ns, all_round(), 100);
    session.run_to_end(300s);
    EXPECT_EQ(session.lines.size(), 100U) << "seed " << seed;
    for (const ReceivedLine& line : session.lines) {
      EXPECT_EQ(line.bins.size(), 20U);
    }
  }
}

TEST(PoorLink, RandomBytesNeverEndAHost) {
  const char* names[] = {"alive_5d",     "alive_4a",     "alive_8a",  "alive_aa",
                         "version_data", "bb_user_data", "head_data", "head_data_4_bit"};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    Client client(ClientConfig{}, 0ns);
    HeadCommand command;
    command.bins = 8;
    TimePoint now{};
    for (int i = 0; i < 3000; ++i) {
      now += std::chrono::milliseconds(random() % 400);
      if (random() % 50 == 0) {
        client.start(now, command, random() % 3);
      }
      Bytes bytes = fixture(names[random() % 8]);
      for (unsigned flips = random() % 3; flips > 0; --flips) {
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      }
      client.on_bytes(now, bytes);
      client.advance(now);
      for (const Bytes& frame : client.take_outgoing()) {
        ASSERT_TRUE(decode_command(frame));
      }
      ASSERT_TRUE(!client.next_deadline() || *client.next_deadline() > now);
    }
    EXPECT_GT(client.statistics().lines, 0U);
  }
}

}  // namespace
}  // namespace sonard::micron
