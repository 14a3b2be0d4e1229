// SPDX-License-Identifier: Apache-2.0
// Frames that are too short, too long, or of no known message (protocol/ping1d/README.md 3.1, 3.2).
#include <gtest/gtest.h>

#include "protocol/ping1d/codec.hpp"

namespace sonard::ping1d {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(Ping1dMalformed, ACommandMustHaveItsLength) {
  for (const std::uint16_t id : {1000, 1001, 1002, 1003, 1004, 1005, 1006, 1400, 1401, 6}) {
    EXPECT_FALSE(decode_command(make_frame(id, 0, 0, {}))) << id;
    EXPECT_FALSE(decode_command(make_frame(id, 0, 0, Bytes(9)))) << id;
  }
  EXPECT_FALSE(decode_command(make_frame(1100, 0, 0, Bytes(1))));
}

TEST(Ping1dMalformed, OnlyMessagesThatCanBeRequestedAreRequestedByAnEmptyFrame) {
  for (int id = 0; id < 3000; ++id) {
    const bool asked =
        id == 4 || id == 5 || (id >= 1200 && id <= 1208) || (id >= 1210 && id <= 1215) || id == 1300;
    EXPECT_EQ(can_be_requested(static_cast<std::uint16_t>(id)), asked) << id;
  }
  EXPECT_TRUE(decode_command(make_frame(1301, 0, 0, {})).value() == Command{Unknown{1301}});
}

TEST(Ping1dMalformed, AReportMayBeLongerButNotShorter) {
  const Bytes distance = encode(Distance{.distance_mm = 5});
  const std::span payload = std::span(distance).subspan(frame_header_size, 24);
  EXPECT_FALSE(decode_report(make_frame(1212, 1, 0, payload.first(23))));
  Bytes longer(payload.begin(), payload.end());
  longer.push_back(7);
  EXPECT_TRUE(decode_report(make_frame(1212, 1, 0, longer)).value() == Report{Distance{.distance_mm = 5}});
}

TEST(Ping1dMalformed, AProfileMustHaveAllOfItsPoints) {
  Bytes payload(26);
  payload[24] = 2;
  EXPECT_FALSE(decode_report(make_frame(1300, 1, 0, payload)));
  payload.resize(28);
  EXPECT_TRUE(decode_report(make_frame(1300, 1, 0, payload)));
}

}  // namespace
}  // namespace sonard::ping1d
