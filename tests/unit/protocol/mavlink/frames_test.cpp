// SPDX-License-Identifier: Apache-2.0
// Frames laid out by hand from the guide's description, with checksums from a second implementation
// (tests/support/mavlink_bytes.hpp).
#include "protocol/mavlink/frames.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string_view>
#include <utility>

#include "protocol/mavlink/checksum.hpp"
#include "tests/support/mavlink_bytes.hpp"

namespace sonard::mavlink {
namespace {

using test::Bytes;
using test::operator+;
using testing::ElementsAre;

struct Read {
  Bytes datagram;  // the frames view these bytes
  std::vector<Frame> frames;
  FrameCounters counters;
};

Read read(Bytes datagram) {
  Read result{std::move(datagram), {}, {}};
  FrameReader reader(result.datagram, result.counters);
  while (const auto frame = reader.next()) {
    result.frames.push_back(*frame);
  }
  return result;
}

TEST(MavlinkChecksum, IsThatOfTheCatalogue) {
  // Check value of CRC-16/MCRF4XX for "123456789", from the catalogue of parametrised CRC algorithms.
  const std::string_view text = "12345678";
  EXPECT_EQ(checksum({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, '9'), 0x6F91);
}

TEST(MavlinkFrames, SeedsFollowFromTheDefinitions) {
  const auto seed = [](MessageId id) { return kind_of(static_cast<std::uint32_t>(id))->seed; };
  const std::string u8 = "uint8_t", u32 = "uint32_t", f = "float";
  EXPECT_EQ(seed(MessageId::heartbeat), test::mavlink_seed("HEARTBEAT", {{u32, "custom_mode"},
                                                                         {u8, "type"},
                                                                         {u8, "autopilot"},
                                                                         {u8, "base_mode"},
                                                                         {u8, "system_status"},
                                                                         {u8, "mavlink_version"}}));
  EXPECT_EQ(seed(MessageId::attitude), test::mavlink_seed("ATTITUDE", {{u32, "time_boot_ms"},
                                                                       {f, "roll"},
                                                                       {f, "pitch"},
                                                                       {f, "yaw"},
                                                                       {f, "rollspeed"},
                                                                       {f, "pitchspeed"},
                                                                       {f, "yawspeed"}}));
  EXPECT_EQ(seed(MessageId::attitude_quaternion),
            test::mavlink_seed("ATTITUDE_QUATERNION", {{u32, "time_boot_ms"},
                                                       {f, "q1"},
                                                       {f, "q2"},
                                                       {f, "q3"},
                                                       {f, "q4"},
                                                       {f, "rollspeed"},
                                                       {f, "pitchspeed"},
                                                       {f, "yawspeed"}}));
  EXPECT_EQ(seed(MessageId::local_position_ned),
            test::mavlink_seed(
                "LOCAL_POSITION_NED",
                {{u32, "time_boot_ms"}, {f, "x"}, {f, "y"}, {f, "z"}, {f, "vx"}, {f, "vy"}, {f, "vz"}}));
  EXPECT_EQ(seed(MessageId::odometry), test::mavlink_seed("ODOMETRY", {{"uint64_t", "time_usec"},
                                                                       {f, "x"},
                                                                       {f, "y"},
                                                                       {f, "z"},
                                                                       {f, "q", 4},
                                                                       {f, "vx"},
                                                                       {f, "vy"},
                                                                       {f, "vz"},
                                                                       {f, "rollspeed"},
                                                                       {f, "pitchspeed"},
                                                                       {f, "yawspeed"},
                                                                       {f, "pose_covariance", 21},
                                                                       {f, "velocity_covariance", 21},
                                                                       {u8, "frame_id"},
                                                                       {u8, "child_frame_id"}}));
}

TEST(MavlinkFrames, BothVersionsAreRead) {
  const Bytes payload{1, 2, 3, 4, 5, 6, 7, 8, 9};
  for (const int version : {1, 2}) {
    const Read got = read(test::mavlink_frame(0, 50, payload, {version, 42, 3}));
    ASSERT_EQ(got.frames.size(), 1U) << version;
    const Frame& frame = got.frames[0];
    EXPECT_EQ(frame.version, version);
    EXPECT_EQ(frame.sequence, 7);
    EXPECT_EQ(frame.system_id, 42);
    EXPECT_EQ(frame.component_id, 3);
    EXPECT_EQ(frame.message_id, 0U);
    EXPECT_EQ(Bytes(frame.payload.begin(), frame.payload.end()), payload);
    EXPECT_EQ(got.counters.stray_bytes, 0U);
  }
}

TEST(MavlinkFrames, SignaturesArePassedOver) {
  const Read got = read(test::heartbeat_frame({2, 1, 1, 0x01}) + test::heartbeat_frame());
  EXPECT_EQ(got.frames.size(), 2U);
  EXPECT_EQ(got.counters.stray_bytes, 0U);
}

TEST(MavlinkFrames, OtherIncompatibleFeaturesAreDropped) {
  const Read got = read(test::heartbeat_frame({2, 1, 1, 0x02}) + test::heartbeat_frame());
  EXPECT_EQ(got.frames.size(), 1U);
  EXPECT_EQ(got.counters.unknown_flags, 1U);
}

TEST(MavlinkFrames, AnyOtherByteBreaksTheChecksum) {
  const Bytes good = test::position_frame(1000, 1, 2, 3);
  for (std::size_t i = 0; i < good.size(); ++i) {
    Bytes bad = good;
    bad[i] ^= 0x10;
    FrameCounters counters;
    FrameReader reader(bad, counters);
    while (const auto frame = reader.next()) {
      EXPECT_EQ(frame->kind, nullptr) << "byte " << i;  // other message numbers cannot be checked
    }
  }
  Bytes bad = good;
  bad.back() ^= 1;
  const Read got = read(bad);
  EXPECT_TRUE(got.frames.empty());
  EXPECT_EQ(got.counters.bad_checksums, 1U);
  EXPECT_EQ(got.counters.stray_bytes, bad.size());
}

TEST(MavlinkFrames, GarbageTakesNoNeighbourAlong) {
  const Bytes good = test::attitude_frame(5, 0, 0, 1);
  Bytes broken = test::attitude_frame(6, 0, 0, 1);
  broken[12] ^= 1;
  // The magic numbers in the garbage claim lengths beyond the next frame, and beyond the datagram.
  const Bytes garbage{0xFD, 30, 0, 0xFE, 255, 0x55};
  const Read got = read(garbage + good + broken + good + garbage + good + Bytes{0xFD, 4});
  EXPECT_EQ(got.frames.size(), 3U);
  for (const Frame& frame : got.frames) {
    EXPECT_EQ(frame.message_id, 30U);
    EXPECT_EQ(frame.payload[0], 5);
  }
  EXPECT_EQ(got.counters.bad_checksums, 1U);
  EXPECT_EQ(got.counters.stray_bytes, 2 * garbage.size() + broken.size() + 2);
}

TEST(MavlinkFrames, MessagesThatAreNotKnownArePassedOverWhole) {
  // SYS_STATUS whose payload contains the bytes of a heartbeat.
  const Bytes unknown = test::mavlink_frame(1, 124, Bytes{1, 2} + test::heartbeat_frame() + Bytes{3});
  const Read got = read(test::heartbeat_frame() + unknown + test::heartbeat_frame() + unknown);
  ASSERT_EQ(got.frames.size(), 4U);
  EXPECT_EQ(got.frames[1].message_id, 1U);
  EXPECT_EQ(got.frames[1].kind, nullptr);
  EXPECT_EQ(got.counters.stray_bytes, 0U);
}

TEST(MavlinkFrames, NothingIsReadPastTheEnd) {
  const Bytes whole = test::odometry_frame(1, 1, 2, 3) + test::position_frame(1, 1, 2, 3, {1});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const Read got = read(cut);
    EXPECT_LE(got.frames.size(), 1U);
  }
}

}  // namespace
}  // namespace sonard::mavlink
