// SPDX-License-Identifier: Apache-2.0
// Messages against bytes laid out by hand from common.xml, and against two frames that another library made.
#include "protocol/mavlink/messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/mavlink_bytes.hpp"

namespace sonard::mavlink {
namespace {

using test::append;
using test::Bytes;
using test::floats;
using test::operator+;

Result<Message, WireError> decoded(const Bytes& datagram) {
  FrameCounters counters;
  FrameReader reader(datagram, counters);
  const auto frame = reader.next();
  EXPECT_TRUE(frame.has_value());
  return frame ? decode(*frame) : Result<Message, WireError>{Message{}};
}

template <class Content>
Content content_of(const Bytes& datagram) {
  const auto message = decoded(datagram);
  EXPECT_TRUE(message && std::holds_alternative<Content>(*message));
  return message && std::holds_alternative<Content>(*message) ? std::get<Content>(*message) : Content{};
}

/// Frames of node-mavlink 2.3.0 for time_boot_ms 1000, x 1, y 2, z 3, at rest, sequence 0, system and
/// component 1. Version 2 cuts trailing zeros off; version 1 does not.
const Bytes third_party_2{0xFD, 0x10, 0x00, 0x00, 0x00, 0x01, 0x01, 0x20, 0x00, 0x00, 0xE8, 0x03, 0x00, 0x00,
                          0x00, 0x00, 0x80, 0x3F, 0x00, 0x00, 0x00, 0x40, 0x00, 0x00, 0x40, 0x40, 0x26, 0x2E};
const Bytes third_party_1{0xFE, 0x1C, 0x00, 0x01, 0x01, 0x20, 0xE8, 0x03, 0x00, 0x00, 0x00, 0x00,
                          0x80, 0x3F, 0x00, 0x00, 0x00, 0x40, 0x00, 0x00, 0x40, 0x40, 0x00, 0x00,
                          0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xF2, 0x50};

TEST(MavlinkMessages, FramesOfAnotherLibrary) {
  const LocalPositionNed expected{1000, 1, 2, 3, 0, 0, 0};
  EXPECT_EQ(content_of<LocalPositionNed>(third_party_2), expected);
  EXPECT_EQ(content_of<LocalPositionNed>(third_party_1), expected);
}

TEST(MavlinkMessages, LocalPositionNed) {
  Bytes payload;
  append(payload, std::uint32_t{123456});
  payload = payload + floats({1.5F, -2.5F, 3.25F, 0.5F, -0.25F, 0.125F});
  ASSERT_EQ(payload.size(), 28U);
  const LocalPositionNed expected{123456, 1.5F, -2.5F, 3.25F, 0.5F, -0.25F, 0.125F};
  for (const int version : {1, 2}) {
    EXPECT_EQ(content_of<LocalPositionNed>(test::mavlink_frame(32, 185, payload, {version})), expected);
  }
}

TEST(MavlinkMessages, GlobalPositionInt) {
  Bytes payload;
  append(payload, std::uint32_t{123456});
  append(payload, std::int32_t{473977418});
  append(payload, std::int32_t{-85455939});
  append(payload, std::int32_t{-30250});
  append(payload, std::int32_t{77});  // relative_alt
  append(payload, std::int16_t{-120});
  append(payload, std::int16_t{50});
  append(payload, std::int16_t{3});
  append(payload, std::uint16_t{9000});  // hdg
  ASSERT_EQ(payload.size(), 28U);
  const std::uint8_t seed = test::mavlink_seed("GLOBAL_POSITION_INT", {{"uint32_t", "time_boot_ms"},
                                                                       {"int32_t", "lat"},
                                                                       {"int32_t", "lon"},
                                                                       {"int32_t", "alt"},
                                                                       {"int32_t", "relative_alt"},
                                                                       {"int16_t", "vx"},
                                                                       {"int16_t", "vy"},
                                                                       {"int16_t", "vz"},
                                                                       {"uint16_t", "hdg"}});
  EXPECT_EQ(content_of<GlobalPositionInt>(test::mavlink_frame(33, seed, payload)),
            (GlobalPositionInt{123456, 473977418, -85455939, -30250, -120, 50, 3, 77}));
}

TEST(MavlinkMessages, Attitude) {
  Bytes payload;
  append(payload, std::uint32_t{99});
  payload = payload + floats({0.1F, 0.2F, 0.3F, 1, 2, 3});
  EXPECT_EQ(content_of<Attitude>(test::mavlink_frame(30, 39, payload)),
            (Attitude{99, 0.1F, 0.2F, 0.3F, 1, 2, 3}));
}

TEST(MavlinkMessages, AttitudeQuaternionWithAndWithoutItsExtension) {
  Bytes payload;
  append(payload, std::uint32_t{99});
  payload = payload + floats({0.5F, 0.25F, -0.5F, 0.75F, 1, 2, 3});
  ASSERT_EQ(payload.size(), 32U);
  const AttitudeQuaternion expected{99, 0.5F, 0.25F, -0.5F, 0.75F, 1, 2, 3};
  EXPECT_EQ(content_of<AttitudeQuaternion>(test::mavlink_frame(31, 246, payload, {1})), expected);
  EXPECT_EQ(content_of<AttitudeQuaternion>(test::mavlink_frame(31, 246, payload + floats({1, 0, 0, 0.5F}))),
            expected);
}

TEST(MavlinkMessages, Odometry) {
  Bytes payload;
  append(payload, std::uint64_t{0x0102030405060708});
  payload = payload + floats({1, 2, 3});                    // x, y, z
  payload = payload + floats({0.5F, -0.5F, 0.25F, 0.75F});  // q
  payload = payload + floats({4, 5, 6, 7, 8, 9});           // velocity, turn rate
  payload.resize(payload.size() + 2 * 21 * 4, 0x55);        // two covariances
  payload = payload + Bytes{20, 12};                        // frame_id, child_frame_id
  ASSERT_EQ(payload.size(), 230U);
  const Odometry expected{
      0x0102030405060708, 1, 2, 3, {0.5F, -0.5F, 0.25F, 0.75F}, 4, 5, 6, 7, 8, 9, MavFrame::local_frd,
      MavFrame::body_frd};
  EXPECT_EQ(content_of<Odometry>(test::mavlink_frame(331, 91, payload)), expected);
  EXPECT_EQ(content_of<Odometry>(test::mavlink_frame(331, 91, payload + Bytes{3, 1, 100})), expected);
}

TEST(MavlinkMessages, ZerosThatWereCutOffComeBack) {
  const Bytes frame = test::position_frame(0, 0, 0, 0);
  ASSERT_EQ(frame.size(), 10U + 1U + 2U);  // at least one byte of payload stays
  EXPECT_EQ(content_of<LocalPositionNed>(frame), LocalPositionNed{});
}

TEST(MavlinkMessages, VersionOneCutsNothing) {
  const auto message = decoded(test::mavlink_frame(32, 185, Bytes(27), {1}));
  ASSERT_FALSE(message);
  EXPECT_EQ(message.error(), (WireError{WireErrorReason::bad_length, 27, "payload"}));
}

TEST(MavlinkMessages, OthersSayNothing) {
  for (const Bytes& frame : {test::heartbeat_frame(), test::mavlink_frame(1, 124, Bytes(31))}) {
    const auto message = decoded(frame);
    ASSERT_TRUE(message);
    EXPECT_TRUE(std::holds_alternative<std::monostate>(*message));
  }
}

}  // namespace
}  // namespace sonard::mavlink
