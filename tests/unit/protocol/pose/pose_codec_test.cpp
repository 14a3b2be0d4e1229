// SPDX-License-Identifier: Apache-2.0
// The pose stream against bytes from other sources than this project's encoder: written by hand from the
// protobuf wire format, and made or read by protoc.
#include "protocol/pose/pose_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "tests/unit/protocol/pose/pose_matchers.hpp"

namespace sonard::pose {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Writes the protobuf wire format: tag = field << 3 | type; type 0 varint, 1 64-bit, 2 length-delimited.
class Wire {
 public:
  Wire& varint(int field, std::uint64_t value) {
    tag(field, 0);
    raw_varint(value);
    return *this;
  }
  Wire& real(int field, double value) {
    tag(field, 1);
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int shift = 0; shift < 64; shift += 8) {
      bytes_.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
    return *this;
  }
  Wire& nested(int field, const Bytes& message) {
    tag(field, 2);
    raw_varint(message.size());
    bytes_.insert(bytes_.end(), message.begin(), message.end());
    return *this;
  }
  Wire& text(int field, std::string_view value) { return nested(field, Bytes(value.begin(), value.end())); }
  operator Bytes() const { return bytes_; }

 private:
  void tag(int field, int type) {
    raw_varint(static_cast<std::uint64_t>(field) << 3 | static_cast<unsigned>(type));
  }
  void raw_varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) {
      bytes_.push_back(static_cast<std::uint8_t>(value | 0x80));
    }
    bytes_.push_back(static_cast<std::uint8_t>(value));
  }
  Bytes bytes_;
};

Bytes wire_vec3(const Vec3& v) {
  return Wire{}.real(1, v.x).real(2, v.y).real(3, v.z);
}
Bytes wire_quat(const Quat& q) {
  return Wire{}.real(1, q.w).real(2, q.x).real(3, q.y).real(4, q.z);
}
Bytes wire_pose(const Vec3& p, const Quat& q) {
  return Wire{}.nested(1, wire_vec3(p)).nested(2, wire_quat(q));
}
Bytes wire_vehicle(const Vec3& p, const Quat& q) {
  return Wire{}.nested(3, wire_pose(p, q));
}
Bytes wire_twist(const Vec3& linear, const Vec3& angular) {
  return Wire{}.nested(1, wire_vec3(linear)).nested(2, wire_vec3(angular));
}
Bytes wire_body(std::string_view name, const Bytes& pose) {
  return Wire{}.text(1, name).nested(2, pose);
}
Bytes joined(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const Bytes good_vehicle = wire_vehicle({1, 2, 3}, {1, 0, 0, 0});

TEST(PoseCodec, DecodesBytesWrittenByHand) {
  const Bytes bytes{0x08, 0xE8, 0x07,                          // time_ns = 1000
                    0x1A, 0x18,                                // vehicle, 24 bytes
                    0x0A, 0x09,                                //   position_m, 9 bytes
                    0x11, 0,    0,    0, 0, 0, 0, 0xF0, 0x3F,  //     y = 1.0
                    0x12, 0x0B,                                //   orientation, 11 bytes
                    0x09, 0,    0,    0, 0, 0, 0, 0xF0, 0x3F,  //     w = 1.0
                    0x78, 0x01};                               //     field 15, unknown: skipped
  const auto sample = decode(bytes);
  ASSERT_TRUE(sample) << to_string(sample.error());
  EXPECT_EQ(sample->time_ns, 1000);
  EXPECT_THAT(sample->T_world_vehicle.position_m, IsVec3(Vec3{0, 1, 0}, 0));
  EXPECT_THAT(sample->T_world_vehicle.orientation, IsRotation(Quat{1, 0, 0, 0}, 0));
  EXPECT_FALSE(sample->twist);
  EXPECT_TRUE(sample->bodies.empty());
}

TEST(PoseCodec, DecodesWhatProtocEncodes) {
  std::ifstream file{POSE_MESSAGE_FILE, std::ios::binary};
  const Bytes bytes{std::istreambuf_iterator<char>{file}, {}};
  ASSERT_FALSE(bytes.empty()) << POSE_MESSAGE_FILE;
  const auto sample = decode(bytes);
  ASSERT_TRUE(sample) << to_string(sample.error());
  EXPECT_EQ(sample->time_ns, -1'500'000'000);
  // The message is in NED and FRD; nose north is a quarter turn left of east.
  EXPECT_THAT(sample->T_world_vehicle.position_m, IsVec3(Vec3{20, 10, -30}, 0));
  EXPECT_THAT(sample->T_world_vehicle.orientation, IsRotation(yaw(1.5707963267948966), 1e-15));
  ASSERT_TRUE(sample->twist);
  EXPECT_THAT(sample->twist->linear_mps, IsVec3(Vec3{1, -2, -3}, 0));
  EXPECT_THAT(sample->twist->angular_radps, IsVec3(Vec3{0.1, -0.2, -0.3}, 0));
  ASSERT_EQ(sample->bodies.size(), 2U);
  EXPECT_EQ(sample->bodies[0].name, "gate");
  EXPECT_THAT(sample->bodies[0].T_world_body.position_m, IsVec3(Vec3{0, -1, -5}, 0));
  // This rotation maps forward to y (east), right to z (down) and down to x (north).
  EXPECT_THAT(rotate(sample->bodies[0].T_world_body.orientation, {1, 0, 0}), IsVec3(Vec3{1, 0, 0}, 1e-15));
  EXPECT_THAT(rotate(sample->bodies[0].T_world_body.orientation, {0, 1, 0}), IsVec3(Vec3{0, 0, 1}, 1e-15));
  ASSERT_TRUE(sample->bodies[0].twist);
  EXPECT_THAT(sample->bodies[0].twist->linear_mps, IsVec3(Vec3{4, -5, -6}, 0));
  EXPECT_THAT(sample->bodies[0].twist->angular_radps, IsVec3(Vec3{0.4, -0.5, -0.6}, 0));
  EXPECT_EQ(sample->bodies[1].name, "buoy");
  EXPECT_FALSE(sample->bodies[1].twist);
}

/// The text that protoc prints for a message.
std::string read_by_protoc(const Bytes& bytes) {
  const std::string path = testing::TempDir() + "sonard_pose_message_" + std::to_string(getpid());
  std::ofstream{path, std::ios::binary}.write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  const std::string command = std::string{PROTOC} + " --proto_path=" + SONARD_SOURCE_DIR +
                              "/protocol/pose --decode=sonard.pose.PoseUpdate pose.proto < " + path;
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> part{};
  while (std::fgets(part.data(), part.size(), pipe) != nullptr) {
    text += part.data();
  }
  EXPECT_EQ(pclose(pipe), 0);
  std::remove(path.c_str());
  return text;
}

TEST(PoseCodec, EncodesWhatProtocDecodes) {
  PoseSample sample;
  sample.time_ns = 42;
  sample.T_world_vehicle = {{1.5, -2.5, 0}, {0.6, 0.8, 0, 0}};
  sample.twist = Velocity{{0.25, 0, 0}, {0, 0, -0.125}};
  sample.bodies = {{"crane", {{0, 0, 7}, {}}, Velocity{{0, 0.5, 0}, {0, 0, 2}}}};
  EXPECT_EQ(
      read_by_protoc(encode(sample)),
      "time_ns: 42\n"
      "vehicle {\n  position_m {\n    x: 1.5\n    y: -2.5\n  }\n  orientation {\n    w: 0.6\n    x: "
      "0.8\n  }\n}\n"
      "twist {\n  linear_mps {\n    x: 0.25\n  }\n  angular_radps {\n    z: -0.125\n  }\n}\n"
      "bodies {\n  name: \"crane\"\n  pose {\n    position_m {\n      z: 7\n    }\n    orientation {\n "
      "     w: 1\n"
      "    }\n  }\n  twist {\n    linear_mps {\n      y: 0.5\n    }\n    angular_radps {\n      z: 2\n    }\n"
      "  }\n}\n");
}

TEST(PoseCodec, RoundTripKeepsEverything) {
  std::mt19937_64 random{7};
  std::uniform_real_distribution<double> coordinate{-1e7, 1e7};
  std::normal_distribution<double> normal;
  const auto any_transform = [&] {
    Transform t{{coordinate(random), coordinate(random), coordinate(random)},
                {normal(random), normal(random), normal(random), normal(random)}};
    t.orientation = normalized(t.orientation);
    return t;
  };
  for (int i = 0; i < 200; ++i) {
    PoseSample sample;
    sample.time_ns = static_cast<std::int64_t>(random() % (2 * std::uint64_t{max_time_ns})) - max_time_ns;
    sample.T_world_vehicle = any_transform();
    if (i % 2 == 0) {
      sample.twist = Velocity{{normal(random), 0, -0.0}, {0, normal(random), 1e6}};
    }
    for (int body = 0; body < i % 4; ++body) {
      sample.bodies.push_back({"body " + std::to_string(body), any_transform()});
      if (body % 2 == 1) {
        sample.bodies.back().twist = Velocity{{normal(random), 0, 0}, {0, 0, normal(random)}};
      }
    }
    const auto back = decode(encode(sample));
    ASSERT_TRUE(back) << to_string(back.error());
    EXPECT_EQ(back->time_ns, sample.time_ns);
    EXPECT_THAT(back->T_world_vehicle.position_m, IsVec3(sample.T_world_vehicle.position_m, 0));
    EXPECT_THAT(back->T_world_vehicle.orientation, IsRotation(sample.T_world_vehicle.orientation, 1e-15));
    ASSERT_EQ(back->twist.has_value(), sample.twist.has_value());
    if (sample.twist) {
      EXPECT_THAT(back->twist->linear_mps, IsVec3(sample.twist->linear_mps, 0));
      EXPECT_THAT(back->twist->angular_radps, IsVec3(sample.twist->angular_radps, 0));
    }
    ASSERT_EQ(back->bodies.size(), sample.bodies.size());
    for (std::size_t body = 0; body < sample.bodies.size(); ++body) {
      EXPECT_EQ(back->bodies[body].name, sample.bodies[body].name);
      EXPECT_THAT(back->bodies[body].T_world_body.position_m,
                  IsVec3(sample.bodies[body].T_world_body.position_m, 0));
      ASSERT_EQ(back->bodies[body].twist.has_value(), sample.bodies[body].twist.has_value());
      if (sample.bodies[body].twist) {
        EXPECT_THAT(back->bodies[body].twist->linear_mps, IsVec3(sample.bodies[body].twist->linear_mps, 0));
        EXPECT_THAT(back->bodies[body].twist->angular_radps,
                    IsVec3(sample.bodies[body].twist->angular_radps, 0));
      }
    }
  }
}

TEST(PoseCodec, EitherSignOfAQuaternionIsOneRotation) {
  const auto plus = decode(wire_vehicle({}, {0.6, 0, 0.8, 0}));
  const auto minus = decode(wire_vehicle({}, {-0.6, 0, -0.8, 0}));
  ASSERT_TRUE(plus && minus);
  EXPECT_THAT(minus->T_world_vehicle.orientation, IsRotation(plus->T_world_vehicle.orientation, 0));
}

TEST(PoseCodec, QuaternionIsScaledToNormOne) {
  const auto sample = decode(wire_vehicle({}, {30, 0, 40, 0}));
  ASSERT_TRUE(sample);
  EXPECT_THAT(sample->T_world_vehicle.orientation, IsRotation(Quat{0.6, 0, 0.8, 0}, 1e-15));
}

struct BadMessage {
  const char* name;
  Bytes bytes;
  PoseError::Kind kind;
  const char* text;
};

void PrintTo(const BadMessage& bad, std::ostream* out) {
  *out << bad.name;
}

class BadMessages : public testing::TestWithParam<BadMessage> {};

TEST_P(BadMessages, AreRefusedWithTheReason) {
  const auto sample = decode(GetParam().bytes);
  ASSERT_FALSE(sample);
  EXPECT_EQ(sample.error().kind, GetParam().kind);
  EXPECT_EQ(to_string(sample.error()), GetParam().text);
}

constexpr auto malformed = PoseError::Kind::malformed;
constexpr auto bad_value = PoseError::Kind::bad_value;
constexpr auto no_rotation = "vehicle: orientation has a norm outside 0.001..1000, so it is not a rotation";

INSTANTIATE_TEST_SUITE_P(
    All, BadMessages,
    testing::Values(
        BadMessage{"position_nan", wire_vehicle({nan, 0, 0}, {}), bad_value,
                   "vehicle: position is not finite"},
        BadMessage{"position_inf", wire_vehicle({0, 0, infinity}, {}), bad_value,
                   "vehicle: position is not finite"},
        BadMessage{"position_far", wire_vehicle({0, 1e38, 0}, {}), bad_value,
                   "vehicle: position is beyond 1e8 m"},
        BadMessage{"quaternion_nan", wire_vehicle({}, {1, nan, 0, 0}), bad_value,
                   "vehicle: orientation is not finite"},
        BadMessage{"quaternion_zero", wire_vehicle({}, {0, 0, 0, 0}), bad_value, no_rotation},
        BadMessage{"quaternion_tiny", wire_vehicle({}, {1e-20, 0, 0, 0}), bad_value, no_rotation},
        BadMessage{"quaternion_huge", wire_vehicle({}, {0, 0, 0, 1e20}), bad_value, no_rotation},
        BadMessage{"quaternion_left_out", Wire{}.nested(3, Wire{}.nested(1, wire_vec3({1, 2, 3}))), bad_value,
                   no_rotation},
        BadMessage{"empty", {}, bad_value, "vehicle: is missing"},
        BadMessage{"no_vehicle", Wire{}.varint(1, 5), bad_value, "vehicle: is missing"},
        BadMessage{"unknown_frame", Wire{}.varint(2, 7).nested(3, wire_pose({}, {})), bad_value,
                   "frame: is neither FRAME_ENU_FLU nor FRAME_NED_FRD"},
        BadMessage{"time_too_late", joined(Wire{}.varint(1, 4'000'000'000'000'000'001), good_vehicle),
                   bad_value, "time_ns: is beyond 4e18"},
        BadMessage{"time_int64_min", joined(Wire{}.varint(1, std::uint64_t{1} << 63), good_vehicle),
                   bad_value, "time_ns: is beyond 4e18"},
        BadMessage{"twist_nan", joined(good_vehicle, Wire{}.nested(4, wire_twist({0, nan, 0}, {}))),
                   bad_value, "twist: is not finite or beyond 1e6"},
        BadMessage{"twist_huge", joined(good_vehicle, Wire{}.nested(4, wire_twist({}, {0, 0, -1.1e6}))),
                   bad_value, "twist: is not finite or beyond 1e6"},
        BadMessage{"body_without_name",
                   joined(good_vehicle, Wire{}.nested(5, wire_body("", wire_pose({}, {})))), bad_value,
                   "bodies.name: is empty"},
        BadMessage{"body_twice",
                   joined(joined(good_vehicle, Wire{}.nested(5, wire_body("a", wire_pose({}, {})))),
                          Wire{}.nested(5, wire_body("a", wire_pose({}, {})))),
                   bad_value, "bodies.name: appears twice in one message"},
        BadMessage{"body_nan",
                   joined(good_vehicle, Wire{}.nested(5, wire_body("a", wire_pose({nan, 0, 0}, {})))),
                   bad_value, "bodies.pose: position is not finite"},
        BadMessage{
            "body_twist_nan",
            joined(good_vehicle, Wire{}.nested(5, joined(wire_body("a", wire_pose({}, {1, 0, 0, 0})),
                                                         Wire{}.nested(3, wire_twist({0, 0, nan}, {}))))),
            bad_value, "bodies.twist: is not finite or beyond 1e6"},
        BadMessage{
            "text", {'h', 'e', 'l', 'l', 'o', '\n'}, malformed, "message: is not a PoseUpdate (pose.proto)"},
        BadMessage{"cut_off", {0x1A, 0x20, 0x0A}, malformed, "message: is not a PoseUpdate (pose.proto)"},
        BadMessage{"too_long", Bytes(max_message_bytes + 1), malformed,
                   "message: is longer than 65507 bytes"}),
    [](const auto& tested) { return tested.param.name; });

TEST(PoseCodec, NoPrefixOfAMessageIsTakenForAnother) {
  // A prefix that ends between two fields decodes to a message without a vehicle. All prefixes must be
  // refused.
  const Bytes whole = joined(Wire{}.varint(1, 9).varint(2, 1), good_vehicle);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(decode(std::span{whole}.first(length))) << length;
  }
  EXPECT_TRUE(decode(whole));
}

TEST(PoseCodec, RefusesBadNamesInSilence) {
  testing::internal::CaptureStderr();
  EXPECT_FALSE(decode(joined(good_vehicle, Wire{}.nested(5, wire_body("\xC0\xFF", wire_pose({}, {}))))));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(PoseCodec, RandomBytesAreHarmless) {
  std::mt19937 random{3};
  const Bytes whole = joined(good_vehicle, Wire{}.nested(5, wire_body("name", wire_pose({1, 2, 3}, {}))));
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = whole;
    for (int flips = 0; flips < 1 + i % 5; ++flips) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    const auto sample = decode(bytes);
    if (sample) {
      EXPECT_NEAR(norm(sample->T_world_vehicle.orientation), 1.0, 1e-12);
      EXPECT_TRUE(is_finite(sample->T_world_vehicle.position_m));
    }
  }
}

TEST(PoseFraming, LengthIsAVarint) {
  PoseSample sample;
  const Bytes small = encode_frame(sample);
  const Bytes message = encode(sample);
  ASSERT_LT(message.size(), 0x80U);
  EXPECT_EQ(small.front(), message.size());
  EXPECT_EQ(next_frame(small), std::ssize(small));

  sample.bodies = {{std::string(300, 'n'), {}}};
  const Bytes large = encode_frame(sample);
  const std::size_t length = encode(sample).size();
  EXPECT_EQ(large[0], 0x80 | (length & 0x7F));
  EXPECT_EQ(large[1], length >> 7);
  EXPECT_EQ(next_frame(large), std::ssize(large));
  EXPECT_EQ(frame_message(large).size(), length);
}

/// The messages in a stream that arrives in pieces of `piece` bytes each.
std::vector<Bytes> messages_of(const Bytes& stream, std::size_t piece) {
  std::vector<Bytes> messages;
  Bytes buffer;
  for (std::size_t at = 0; at < stream.size(); at += piece) {
    const std::size_t length = std::min(piece, stream.size() - at);
    const auto part = std::span{stream}.subspan(at, length);
    buffer.insert(buffer.end(), part.begin(), part.end());
    for (std::ptrdiff_t n = next_frame(buffer); n != 0; n = next_frame(buffer)) {
      EXPECT_GT(n, 0);
      const auto message = frame_message(std::span{buffer}.first(static_cast<std::size_t>(n)));
      messages.emplace_back(message.begin(), message.end());
      buffer.erase(buffer.begin(), buffer.begin() + n);
    }
  }
  EXPECT_TRUE(buffer.empty());
  return messages;
}

TEST(PoseFraming, SplitAndMergedReadsGiveTheSameMessages) {
  std::vector<Bytes> sent;
  Bytes stream;
  for (const std::size_t name_length : {1, 100, 200, 20'000}) {
    PoseSample sample;
    sample.bodies = {{std::string(name_length, 'b'), {}}};
    sent.push_back(encode(sample));
    const Bytes frame = encode_frame(sample);
    stream.insert(stream.end(), frame.begin(), frame.end());
  }
  for (const std::size_t piece :
       {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{64}, stream.size()}) {
    EXPECT_EQ(messages_of(stream, piece), sent) << piece;
  }
}

TEST(PoseFraming, AnIncompleteFrameNeedsMore) {
  EXPECT_EQ(next_frame({}), 0);
  EXPECT_EQ(next_frame(Bytes{0x05, 1, 2, 3, 4}), 0);
  EXPECT_EQ(next_frame(Bytes{0x80}), 0);
  EXPECT_EQ(next_frame(Bytes{0xE3, 0xFF}), 0);
  EXPECT_EQ(next_frame(Bytes{0xE3, 0xFF, 0x03}), 0) << "65507, the longest message there is";
}

TEST(PoseFraming, AnImpossibleLengthDropsTheBuffer) {
  EXPECT_EQ(next_frame(Bytes{0xE4, 0xFF, 0x03, 9, 9}), -5) << "65508, one too many";
  EXPECT_EQ(next_frame(Bytes{0xFF, 0xFF, 0xFF}), -3) << "a varint of four bytes or more";
  EXPECT_EQ(next_frame(Bytes{'G', 'E', 'T', ' '}), 0) << "text may look like a length: decode() tells";
}

TEST(PoseFraming, AnEmptyMessageIsAFrame) {
  const Bytes stream{0x00, 0x00};
  EXPECT_EQ(next_frame(stream), 1);
  EXPECT_TRUE(frame_message(std::span{stream}.first(1)).empty());
}

TEST(PoseFraming, TheLongestFrameFitsTheStatedBuffer) {
  PoseSample sample;
  sample.bodies = {{std::string(65'000, 'b'), {}}};
  const Bytes frame = encode_frame(sample);
  EXPECT_LE(frame.size(), max_frame_bytes);
  EXPECT_EQ(next_frame(frame), std::ssize(frame));
}

}  // namespace
}  // namespace sonard::pose
