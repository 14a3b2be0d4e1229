// SPDX-License-Identifier: Apache-2.0
// Commands in a stream, as clients send them (protocol/oculus/README.md 3.1).
#include <gtest/gtest.h>

#include "protocol/oculus/frame.hpp"
#include "tests/unit/protocol/oculus/codec/fixture.hpp"

namespace sonard::oculus::testing {
namespace {

const std::vector<std::string> all_commands{"fire_vendor",          "fire_ensta",
                                            "fire_ensta_standby",   "fire_ensta_resume_v2",
                                            "fire_liboculus_8_bit", "fire_liboculus_32_bit",
                                            "user_config_request"};

std::vector<Bytes> take_all(CommandBuffer& buffer) {
  std::vector<Bytes> found;
  while (const auto command = buffer.front()) {
    found.emplace_back(command->begin(), command->end());
    buffer.pop();
  }
  return found;
}

Bytes all_in_one() {
  Bytes stream;
  for (const std::string& name : all_commands) {
    const Bytes bytes = load_fixture(name);
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  return stream;
}

std::vector<Bytes> all_apart() {
  std::vector<Bytes> commands;
  for (const std::string& name : all_commands) {
    commands.push_back(load_fixture(name));
  }
  return commands;
}

/// Bytes of a fire whose header states a payload of `payload_size` bytes.
Bytes fire_announcing(std::uint32_t payload_size) {
  Bytes bytes = load_fixture("fire_ensta");
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[10 + i] = static_cast<std::uint8_t>(payload_size >> (8 * i));
  }
  return bytes;
}

TEST(OculusCommands, SeveralInOneSegment) {
  CommandBuffer buffer;
  buffer.append(all_in_one());
  EXPECT_EQ(take_all(buffer), all_apart());
  EXPECT_EQ(buffer.dropped(), 0U);
}

TEST(OculusCommands, SplitAtAnyByte) {
  const Bytes stream = all_in_one();
  for (std::size_t at = 0; at <= stream.size(); ++at) {
    CommandBuffer buffer;
    buffer.append(std::span(stream).first(at));
    std::vector<Bytes> found = take_all(buffer);
    buffer.append(std::span(stream).subspan(at));
    for (Bytes& command : take_all(buffer)) {
      found.push_back(std::move(command));
    }
    ASSERT_EQ(found, all_apart()) << "split at " << at;
  }
}

TEST(OculusCommands, ByteByByte) {
  CommandBuffer buffer;
  std::vector<Bytes> found;
  for (const std::uint8_t byte : all_in_one()) {
    buffer.append({&byte, 1});
    for (Bytes& command : take_all(buffer)) {
      found.push_back(std::move(command));
    }
  }
  EXPECT_EQ(found, all_apart());
}

TEST(OculusCommands, AFireWithoutASizeIsAsLongAsItsVersion) {
  Bytes bytes = load_fixture("fire_liboculus_32_bit");
  bytes[10] = 0;
  CommandBuffer buffer;
  buffer.append(bytes);
  const auto found = take_all(buffer);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(std::get<SimpleFire>(*decode_command(found[0])).extension);
}

TEST(OculusCommands, BytesBetweenAreSkipped) {
  Bytes stream{0x53, 0x00, 0x4F, 0x53, 0x53};
  const Bytes fire = load_fixture("fire_ensta");
  stream.insert(stream.end(), fire.begin(), fire.end());
  CommandBuffer buffer;
  buffer.append(stream);
  EXPECT_EQ(take_all(buffer), std::vector<Bytes>{fire});
  EXPECT_EQ(buffer.dropped(), 5U);
}

TEST(OculusCommands, AFireThatIsTooShortIsAnError) {
  Bytes bytes = fire_announcing(36);
  bytes.resize(16 + 36);
  CommandBuffer buffer;
  buffer.append(bytes);
  const auto found = take_all(buffer);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(decode_command(found[0]));
}

TEST(OculusCommands, AFireOf72BytesHasNoExtension) {
  Bytes bytes = fire_announcing(72);
  bytes.resize(16 + 72);
  EXPECT_FALSE(std::get<SimpleFire>(*decode_command(bytes)).extension);
  bytes = fire_announcing(73);
  bytes.resize(16 + 73);
  EXPECT_TRUE(std::get<SimpleFire>(*decode_command(bytes)).extension);
}

TEST(OculusCommands, WhatIsLongerThan4096EndsTheConnection) {
  CommandBuffer buffer;
  buffer.append(fire_announcing(4096));
  EXPECT_FALSE(buffer.front());
  EXPECT_FALSE(buffer.broken());
  buffer.clear();
  buffer.append(fire_announcing(4097));
  EXPECT_FALSE(buffer.front());
  EXPECT_TRUE(buffer.broken());
  buffer.append(load_fixture("fire_ensta"));
  EXPECT_FALSE(buffer.front());
  buffer.clear();
  buffer.append(load_fixture("fire_ensta"));
  EXPECT_TRUE(buffer.front());
}

}  // namespace
}  // namespace sonard::oculus::testing
