// SPDX-License-Identifier: Apache-2.0
// Invalid bytes are refused with their offset, and nothing is read beyond the end.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "protocol/micron/codec.hpp"
#include "tests/unit/protocol/micron/codec/fixture.hpp"

namespace sonard::micron::testing {
namespace {

TEST(Malformed, EveryShortenedExampleIsRefusedOrMeansAShorterMessage) {
  for (const auto& name : fixture_names()) {
    const Bytes whole = load_fixture(name);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      const auto command = decode_command(cut);
      const auto report = decode_report(cut);
      EXPECT_TRUE(size >= min_frame_size || (!command && !report)) << name << " " << size;
      EXPECT_TRUE(command || command.error().offset <= size);
      EXPECT_TRUE(report || report.error().offset <= size);
    }
  }
}

TEST(Malformed, UnknownTypesAreTold) {
  Bytes bytes = load_fixture("send_version");
  for (const int type : {0, 3, 5, 20, 26, 58, 61, 72, 255}) {
    bytes[10] = static_cast<std::uint8_t>(type);
    EXPECT_TRUE(*decode_command(bytes) == Command{Unknown{bytes[10]}}) << type;
    EXPECT_TRUE(*decode_report(bytes) == Report{Unknown{bytes[10]}}) << type;
  }
}

TEST(Malformed, HeadCommandOfUnknownForm) {
  Bytes bytes = load_fixture("head_command_ros");
  bytes[13] = 0x02;
  EXPECT_EQ(decode_command(bytes).error(), (WireError{WireErrorReason::bad_value, 13, "form"}));
}

TEST(Malformed, LineWhoseCountsDisagree) {
  Bytes bytes = load_fixture("head_data");
  bytes[42] = 7;
  EXPECT_EQ(decode_report(bytes).error(), (WireError{WireErrorReason::bad_length, 13, "total_count"}));
  bytes[42] = 9;
  EXPECT_EQ(decode_report(bytes).error(), (WireError{WireErrorReason::truncated, 44, "data"}));
}

TEST(Malformed, UserBlocksOfAnotherLength) {
  Bytes bytes = load_fixture("bb_user_data");
  bytes.pop_back();
  EXPECT_EQ(decode_report(bytes).error().reason, WireErrorReason::bad_length);
}

TEST(Malformed, RandomFramesDecodeToWhatEncodesAgain) {
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes(random() % 300);
    std::ranges::generate(bytes, [&] { return static_cast<std::uint8_t>(random()); });
    if (bytes.size() > 13) {
      const std::uint8_t types[] = {1, 2, 4, 6, 8, 16, 19, 23, 25, 57, 63};
      const std::uint8_t forms[] = {0x01, 0x1D, 0x1E, 0x0F};
      bytes[10] = types[random() % 11];
      bytes[13] = forms[random() % 4];
    }
    if (const auto command = decode_command(bytes)) {
      EXPECT_TRUE(*decode_command(encode(*command)) == *command);
    }
    if (const auto report = decode_report(bytes)) {
      const Bytes again = encode(*report);
      EXPECT_TRUE(*decode_report(again) == *report);
    }
  }
}

}  // namespace
}  // namespace sonard::micron::testing
