// SPDX-License-Identifier: Apache-2.0
// Invalid bytes are refused with their offset. Any message that was decoded can be encoded and decoded again.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "protocol/ping360/codec.hpp"
#include "tests/unit/protocol/ping360/codec/fixture.hpp"

namespace sonard::ping360::testing {
namespace {

constexpr std::uint16_t all_ids[] = {1,    2,    3,    4,    5,    6,    100, 2000,
                                     2300, 2301, 2600, 2601, 2602, 2903, 7,   65535};

TEST(Ping360Malformed, EveryShortenedExampleIsRefusedOrMeansAShorterMessage) {
  for (const auto& name : fixture_names()) {
    const Bytes whole = load_fixture(name);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      const auto command = decode_command(cut);
      const auto report = decode_report(cut);
      EXPECT_TRUE(size >= frame_overhead || (!command && !report)) << name << " " << size;
      EXPECT_TRUE(command || command.error().offset <= size);
      EXPECT_TRUE(report || report.error().offset <= size);
    }
  }
}

TEST(Ping360Malformed, ACommandHasItsLengthToTheByte) {
  EXPECT_EQ(decode_command(make_frame(2601, 0, 0, Bytes(13))).error(),
            (WireError{WireErrorReason::truncated, 21, "spare"}));
  EXPECT_EQ(decode_command(make_frame(2602, 0, 0, Bytes(15))).error(),
            (WireError{WireErrorReason::truncated, 23, "delay"}));
  EXPECT_EQ(decode_command(make_frame(2601, 0, 0, Bytes(15))).error(),
            (WireError{WireErrorReason::bad_length, 22, "payload"}));
  EXPECT_EQ(decode_command(make_frame(2903, 0, 0, Bytes(1))).error(),
            (WireError{WireErrorReason::bad_length, 8, "payload"}));
  EXPECT_EQ(decode_command(make_frame(6, 0, 0, {})).error(),
            (WireError{WireErrorReason::truncated, 8, "requested_id"}));
}

TEST(Ping360Malformed, AReportMayGoOnBehindItsMessage) {
  EXPECT_TRUE(*decode_report(make_frame(4, 2, 0, Bytes{2, 1, 3, 3, 8, 0, 77})) ==
              (Report{DeviceInformation{2, 1, 3, 3, 8}}));
}

TEST(Ping360Malformed, SamplesThatAreNotThere) {
  Bytes payload(14 + 5);
  payload[12] = 6;
  EXPECT_EQ(decode_report(make_frame(2300, 2, 0, payload)).error(),
            (WireError{WireErrorReason::truncated, 22, "data"}));
}

TEST(Ping360Malformed, UnknownNumbersAreToldAndKept) {
  for (const std::uint16_t id : {0, 7, 99, 101, 1001, 2001, 2302, 2603, 3000, 65535}) {
    const Bytes frame = make_frame(id, 0, 0, Bytes(5));
    EXPECT_TRUE(*decode_command(frame) == Command{Unknown{id}}) << id;
    EXPECT_TRUE(*decode_report(frame) == Report{Unknown{id}}) << id;
    EXPECT_EQ(id_of(Command{Unknown{id}}), id);
    EXPECT_EQ(id_of(Report{Unknown{id}}), id);
  }
  EXPECT_TRUE(*decode_command(load_fixture("device_data")) == Command{Unknown{2300}});
  EXPECT_TRUE(*decode_report(load_fixture("transducer")) == Report{Unknown{2601}});
}

TEST(Ping360Malformed, AnEmptyMessageOfThreeKindsIsARequest) {
  for (const std::uint16_t id : {4, 5, 2300}) {
    EXPECT_TRUE(*decode_command(make_frame(id, 0, 0, {})) == Command{GeneralRequest{id}}) << id;
  }
  EXPECT_TRUE(*decode_command(make_frame(2301, 0, 0, {})) == Command{Unknown{2301}});
}

TEST(Ping360Malformed, WhatIsTooLongIsCutWhenItIsWritten) {
  const Bytes many(5000, 7);
  EXPECT_EQ(encode(DeviceData{.data = many}).size(), max_payload_size + frame_overhead);
  EXPECT_EQ(encode(Nack{6, std::string(5000, 'x')}).size(), max_payload_size + frame_overhead);
  EXPECT_GT(next_frame(encode(AutoDeviceData{.data = many})), 0);
}

TEST(Ping360Malformed, RandomFramesDecodeToWhatEncodesAgain) {
  std::mt19937 random(1);
  int commands = 0;
  int reports = 0;
  for (int i = 0; i < 40'000; ++i) {
    const std::size_t sizes[] = {0, 1, 2, 4, 6, 14, 16, 20, random() % 60};
    Bytes payload(sizes[random() % 9]);
    std::ranges::generate(payload, [&] { return static_cast<std::uint8_t>(random()); });
    const bool small_counts = random() % 2 == 0;
    for (const std::size_t count : {12U, 18U}) {
      if (small_counts && payload.size() > count + 1) {
        payload[count] = static_cast<std::uint8_t>(random() % 20);
        payload[count + 1] = 0;
      }
    }
    const Bytes frame = make_frame(all_ids[random() % 16], 0, 0, payload);
    const auto command = decode_command(frame);
    // An unknown message keeps only its number. Without its payload, it may decode as an older request.
    if (command && !std::holds_alternative<Unknown>(*command)) {
      ++commands;
      EXPECT_TRUE(*decode_command(encode(*command)) == *command);
    }
    if (const auto report = decode_report(frame)) {
      ++reports;
      const Bytes again = encode(*report);
      EXPECT_TRUE(*decode_report(again) == *report);
    }
  }
  EXPECT_GT(commands, 2000);
  EXPECT_GT(reports, 5000);
}

}  // namespace
}  // namespace sonard::ping360::testing
