// SPDX-License-Identifier: Apache-2.0
#include "server/web/head_picture.hpp"

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using std::chrono::milliseconds;

std::shared_ptr<const ShownPing> fan(std::uint64_t number) {
  auto shown = std::make_shared<ShownPing>();
  PingRecord& record = shown->record;
  record.number = number;
  record.bearings_rad = {-0.5, 0.0, 0.5};
  record.settings.beams = 3;
  record.settings.bins = 20;
  record.settings.bin_m = 0.1;
  record.samples.assign(60, 100);
  return shown;
}

TEST(HeadPicture, IsDrawnOnceForAllViewers) {
  HeadPicture picture;
  const Pings pings{fan(1)};
  ASSERT_TRUE(picture.begin(pings.back(), TimePoint{}, milliseconds{100}));
  EXPECT_FALSE(picture.begin(fan(2), TimePoint{} + milliseconds{500}, milliseconds{100})) << "one at a time";
  picture.drawn(picture.draw(pings, "bow"));
  EXPECT_NE(picture.text(), nullptr);
  for (int viewer = 0; viewer < 60; ++viewer) {
    EXPECT_FALSE(picture.begin(pings.back(), TimePoint{} + milliseconds{500 * viewer}, milliseconds{100}));
  }
}

TEST(HeadPicture, IsDrawnAgainForANewerPingAfterTheInterval) {
  HeadPicture picture;
  ASSERT_TRUE(picture.begin(fan(1), TimePoint{}, milliseconds{100}));
  picture.drawn(nullptr);
  EXPECT_FALSE(picture.begin(fan(2), TimePoint{} + milliseconds{99}, milliseconds{100}));
  EXPECT_TRUE(picture.begin(fan(2), TimePoint{} + milliseconds{100}, milliseconds{100}));
}

}  // namespace
}  // namespace sonard::server
