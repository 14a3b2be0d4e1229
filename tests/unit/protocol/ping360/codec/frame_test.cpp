// SPDX-License-Identifier: Apache-2.0
// Boundaries of frames in a stream (protocol/ping360/README.md 1.1).
#include "protocol/ping/frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/unit/protocol/ping360/codec/fixture.hpp"

namespace sonard::ping360::testing {
namespace {

using namespace ping;
using namespace std::chrono_literals;

Bytes joined(const std::vector<Bytes>& pieces) {
  Bytes all;
  for (const Bytes& piece : pieces) {
    all.insert(all.end(), piece.begin(), piece.end());
  }
  return all;
}

std::vector<Bytes> frames_in(FrameBuffer& buffer) {
  std::vector<Bytes> frames;
  while (const auto frame = buffer.front()) {
    frames.emplace_back(frame->begin(), frame->end());
    buffer.pop();
  }
  return frames;
}

std::vector<Bytes> frames_of(const Bytes& stream, std::size_t piece) {
  FrameBuffer buffer;
  std::vector<Bytes> frames;
  for (std::size_t begin = 0; begin < stream.size(); begin += piece) {
    buffer.append({}, std::span{stream}.subspan(begin, std::min(piece, stream.size() - begin)));
    for (const Bytes& frame : frames_in(buffer)) {
      frames.push_back(frame);
    }
  }
  return frames;
}

TEST(Ping360Frame, HeaderAndChecksumAreWhereTheyBelong) {
  const Bytes frame = make_frame(0x0A29, 3, 9, Bytes{0xFF, 0xFF});
  EXPECT_EQ(frame, (Bytes{0x42, 0x52, 2, 0, 0x29, 0x0A, 3, 9, 0xFF, 0xFF, 0xD3, 0x02}));
  EXPECT_EQ(frame_header(frame), (FrameHeader{2, 2601, 3, 9}));
}

TEST(Ping360Frame, FramesAreFoundHoweverTheStreamIsCut) {
  std::vector<Bytes> frames;
  for (const std::string& name : fixture_names()) {
    frames.push_back(load_fixture(name));
  }
  const Bytes stream = joined(frames);
  for (const std::size_t piece : {1U, 2U, 3U, 7U, 100U, 5000U}) {
    EXPECT_EQ(frames_of(stream, piece), frames) << piece;
  }
}

TEST(Ping360Frame, AStartByteMayBeFollowedByAFrame) {
  const Bytes frame = load_fixture("motor_off");
  EXPECT_EQ(frames_of(joined({{'B'}, frame}), 1), std::vector<Bytes>{frame}) << "B B R ...";
  EXPECT_EQ(frames_of(joined({{'B', 'R'}, frame}), 1), std::vector<Bytes>{frame}) << "a length of 0x5242";
}

TEST(Ping360Frame, AWrongChecksumCostsOneFrame) {
  Bytes broken = load_fixture("transducer");
  broken[12] ^= 1;
  const Bytes frame = load_fixture("motor_off");
  FrameBuffer buffer;
  buffer.append({}, joined({broken, frame, broken}));
  EXPECT_EQ(frames_in(buffer), std::vector<Bytes>{frame});
  EXPECT_EQ(buffer.bad_checksums(), 2U);
  EXPECT_EQ(buffer.dropped(), 2 * broken.size());
}

TEST(Ping360Frame, AFrameInsideOfABrokenOneIsFound) {
  const Bytes frame = load_fixture("request_device_information");
  const Bytes long_header{0x42, 0x52, 0x10, 0x00, 0x29, 0x0A, 0x00, 0x00};
  EXPECT_EQ(frames_of(joined({long_header, frame, frame}), 1), (std::vector<Bytes>{frame, frame}));
}

TEST(Ping360Frame, ALengthBeyondTheLimitIsNoFrame) {
  const Bytes at_the_limit = make_frame(1, 0, 0, Bytes(max_payload_size));
  const Bytes beyond = make_frame(1, 0, 0, Bytes(max_payload_size + 1));
  EXPECT_EQ(next_frame(at_the_limit), static_cast<std::ptrdiff_t>(at_the_limit.size()));
  EXPECT_EQ(next_frame(std::span{beyond}.first(4)), -1);
}

TEST(Ping360Frame, ABufferForShortFramesDropsLongerOnesAtTheirLength) {
  const Bytes frame = load_fixture("motor_off");
  const Bytes long_header{0x42, 0x52, 65, 0x00};
  FrameBuffer buffer(64);
  buffer.append({}, joined({long_header, frame, make_frame(1, 0, 0, Bytes(64))}));
  EXPECT_EQ(frames_in(buffer).size(), 2U);
  EXPECT_EQ(buffer.dropped(), long_header.size());
}

TEST(Ping360Frame, WhatStopsToComeFor100MsIsGivenUp) {
  const Bytes frame = load_fixture("motor_off");
  const Bytes header_of_many{0x42, 0x52, 0xFF, 0x0F, 'U'};
  FrameBuffer buffer;
  buffer.append(0s, header_of_many);
  buffer.append(99ms, frame);
  EXPECT_TRUE(frames_in(buffer).empty());
  buffer.append(199ms, frame);
  EXPECT_EQ(frames_in(buffer).size(), 1U);
  EXPECT_EQ(buffer.dropped(), header_of_many.size() + frame.size());
  EXPECT_FALSE(buffer.take_baud_bytes()) << "they were in a frame";
}

TEST(Ping360Frame, BaudBytesCountBetweenFramesOnly) {
  FrameBuffer buffer;
  buffer.append({}, make_frame(3, 0, 0, Bytes{'U', 'U'}));
  EXPECT_EQ(frames_in(buffer).size(), 1U);
  EXPECT_FALSE(buffer.take_baud_bytes());
  Bytes broken = make_frame(3, 0, 0, Bytes{'U', 'U'});
  broken.back() ^= 1;
  buffer.append({}, broken);
  EXPECT_TRUE(frames_in(buffer).empty());
  EXPECT_FALSE(buffer.take_baud_bytes());
  buffer.append({}, Bytes{'U'});
  EXPECT_TRUE(frames_in(buffer).empty());
  EXPECT_TRUE(buffer.take_baud_bytes());
  EXPECT_FALSE(buffer.take_baud_bytes()) << "once";
}

TEST(Ping360Frame, WhatIsClearedDoesNotSpoilWhatComes) {
  FrameBuffer buffer;
  buffer.append({}, Bytes{0x42, 0x52, 0xFF, 0x0F});
  buffer.clear();
  buffer.append({}, load_fixture("motor_off"));
  EXPECT_EQ(frames_in(buffer).size(), 1U);
}

TEST(Ping360Frame, JunkHoldsNoMemoryAndHidesNoFrameForEver) {
  std::mt19937 random(1);
  FrameBuffer buffer;
  std::size_t found = 0;
  for (int i = 0; i < 20'000; ++i) {
    Bytes piece(random() % 40);
    std::ranges::generate(piece, [&] { return static_cast<std::uint8_t>("BR\0\x01U"[random() % 5]); });
    buffer.append({}, piece);
    found += frames_in(buffer).size();
  }
  EXPECT_GT(buffer.dropped(), 300'000U);
  for (int i = 0; i < 400; ++i) {
    buffer.append({}, load_fixture("motor_off"));
    found += frames_in(buffer).size();
  }
  EXPECT_GE(found, 400U);
}

}  // namespace
}  // namespace sonard::ping360::testing
