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
  const auto first = picture.newest(pings, "bow", TimePoint{}, milliseconds{100});
  ASSERT_NE(first, nullptr);
  for (int viewer = 0; viewer < 60; ++viewer) {
    EXPECT_EQ(picture.newest(pings, "bow", TimePoint{} + milliseconds{500 * viewer}, milliseconds{100}),
              first);
  }
}

TEST(HeadPicture, IsDrawnAgainForANewerPingAfterTheInterval) {
  HeadPicture picture;
  const auto first = picture.newest({fan(1)}, "bow", TimePoint{}, milliseconds{100});
  EXPECT_EQ(picture.newest({fan(2)}, "bow", TimePoint{} + milliseconds{99}, milliseconds{100}), first);
  EXPECT_NE(picture.newest({fan(2)}, "bow", TimePoint{} + milliseconds{100}, milliseconds{100}), first);
}

}  // namespace
}  // namespace sonard::server
