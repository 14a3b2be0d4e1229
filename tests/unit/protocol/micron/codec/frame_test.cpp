// SPDX-License-Identifier: Apache-2.0
// Frames in a stream: any chunks, noise, wrong lengths, cut frames (protocol/micron/README.md 2).
#include "protocol/micron/frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>

#include "tests/unit/protocol/micron/codec/fixture.hpp"

namespace sonard::micron::testing {
namespace {

using namespace std::chrono_literals;

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// All frames that are complete in the buffer now.
std::vector<Bytes> frames_in(FrameBuffer& buffer, TimePoint now) {
  std::vector<Bytes> frames;
  while (const auto frame = buffer.front(now)) {
    frames.emplace_back(frame->bytes.begin(), frame->bytes.end());
    buffer.pop();
  }
  return frames;
}

TEST(NextFrame, KeepsTheContract) {
  const Bytes frame = load_fixture("send_version");
  EXPECT_EQ(next_frame({}, 1006), 0);
  EXPECT_EQ(next_frame(frame, 1006), 14);
  EXPECT_EQ(next_frame(frame + Bytes{1, 2, 3}, 1006), 14);
  EXPECT_EQ(next_frame(Bytes{1, 2, 3} + frame, 1006), -3);
  EXPECT_EQ(next_frame(Bytes{1, 2, 3}, 1006), -3);
  for (std::size_t size = 1; size < frame.size(); ++size) {
    EXPECT_EQ(next_frame(std::span{frame}.first(size), 1006), 0) << size;
  }
}

TEST(NextFrame, DropsOneByteOfWhatIsNoFrame) {
  const Bytes frame = load_fixture("send_version");
  const auto with = [&](std::size_t offset, std::uint8_t value) {
    Bytes bytes = frame;
    bytes[offset] = value;
    return next_frame(bytes, 1006);
  };
  EXPECT_EQ(with(13, 0x0D), -1) << "no line feed at the end";
  EXPECT_EQ(with(4, '9'), -1) << "lengths differ";
  EXPECT_EQ(with(5, 9), -1);
  EXPECT_EQ(with(6, 1), -1);
  EXPECT_EQ(with(3, 'g'), -1) << "no hexadecimal digit";
  EXPECT_EQ(with(7, 0x55), 14) << "nodes, count, sequence are not looked at";
  EXPECT_EQ(with(9, 0x55), 14);
  EXPECT_EQ(with(11, 0), 14);
}

TEST(NextFrame, TakesLengthsFrom8ToTheLimitAndDigitsOfEitherCase) {
  const auto stated = [](const char* digits, std::uint8_t low, std::uint8_t high, std::size_t limit) {
    Bytes bytes{'@'};
    bytes.insert(bytes.end(), digits, digits + 4);
    return next_frame(bytes + Bytes{low, high}, limit);
  };
  EXPECT_EQ(stated("0007", 7, 0, max_command_frame_size), -1);
  EXPECT_EQ(stated("0008", 8, 0, max_command_frame_size), 0);
  EXPECT_EQ(stated("03E8", 0xE8, 3, max_command_frame_size), 0);
  EXPECT_EQ(stated("03e8", 0xE8, 3, max_command_frame_size), 0);
  EXPECT_EQ(stated("03E9", 0xE9, 3, max_command_frame_size), -1);
  EXPECT_EQ(stated("03E9", 0xE9, 3, max_report_frame_size), 0);
}

TEST(FrameBuffer, FindsEveryExampleInOnePieceAndByteByByte) {
  Bytes stream;
  std::vector<Bytes> expected;
  for (const auto& name : fixture_names()) {
    expected.push_back(load_fixture(name));
    stream = stream + expected.back();
  }
  FrameBuffer whole{max_report_frame_size};
  whole.append(0ns, stream);
  EXPECT_EQ(frames_in(whole, 0ns), expected);
  EXPECT_EQ(whole.dropped(), 0U);

  FrameBuffer bytewise{max_report_frame_size};
  std::vector<Bytes> found;
  for (const std::uint8_t byte : stream) {
    bytewise.append(0ns, std::span{&byte, 1});
    for (auto& frame : frames_in(bytewise, 0ns)) {
      found.push_back(std::move(frame));
    }
  }
  EXPECT_EQ(found, expected);
}

TEST(FrameBuffer, FindsAFrameBehindNoiseThatLooksLikeOne) {
  const Bytes frame = load_fixture("head_command_ros");
  const Bytes noise[] = {{'@'},
                         {'@', '@', 0x0A},
                         {'@', '0', '0', '0', '8', 8},
                         {'@', '0', '0', '0', '8', 8, 0, 0xFF},
                         {0x0A, '@', '0', '0', '1', 'A', 0x1A, 0, 1, 2, 3}};
  for (const Bytes& junk : noise) {
    FrameBuffer buffer{max_command_frame_size};
    buffer.append(0ns, junk + frame);
    EXPECT_EQ(frames_in(buffer, 0ns), std::vector<Bytes>{frame}) << junk.size();
    EXPECT_EQ(buffer.dropped(), junk.size());
  }
}

TEST(FrameBuffer, SurvivesNoiseInAnyChunks) {
  const Bytes frame = load_fixture("send_data");
  for (unsigned seed = 1; seed <= 50; ++seed) {
    std::mt19937 random(seed);
    Bytes stream;
    constexpr std::size_t frames = 40;
    for (std::size_t i = 0; i < frames; ++i) {
      for (unsigned n = random() % 12; n > 0; --n) {
        const std::uint8_t likely[] = {'@', 0x0A, '0', static_cast<std::uint8_t>(random())};
        stream.push_back(likely[random() % 4]);
      }
      stream = stream + frame;
    }
    FrameBuffer buffer{max_command_frame_size};
    std::size_t found = 0;
    for (std::size_t begin = 0; begin < stream.size();) {
      const std::size_t count = std::min<std::size_t>(1 + random() % 40, stream.size() - begin);
      buffer.append(0ns, std::span{stream}.subspan(begin, count));
      begin += count;
      for (const Bytes& each : frames_in(buffer, 0ns)) {
        found += each == frame ? 1U : 0U;
      }
    }
    EXPECT_EQ(found, frames) << "seed " << seed;
  }
}

// The reboot command of one public driver states a length of 18 bytes and has 14 (2.4).
const Bytes cut_reboot{0x40, 0x30, 0x30, 0x30, 0x43, 0x0C, 0x00, 0xFF, 0x02, 0x07, 0x10, 0x80, 0x02, 0x0A};

TEST(FrameBuffer, AHeadCommandThatLostAByteCostsNoOtherCommand) {
  Bytes stream = load_fixture("head_command_ros");
  stream.erase(stream.begin() + 30);
  const Bytes next = load_fixture("send_version");
  stream.insert(stream.end(), next.begin(), next.end());
  FrameBuffer buffer(max_command_frame_size);
  buffer.append(0ns, stream);
  const auto frame = buffer.front(0ns);
  ASSERT_TRUE(frame);
  EXPECT_EQ(Bytes(frame->bytes.begin(), frame->bytes.end()), next);
}

TEST(FrameBuffer, TakesALengthOfFiveDigitsHoweverTheStreamIsCut) {
  for (const std::size_t data_size : {53U, 247U, 248U, 502U, 503U}) {  // lengths of one byte and of two
    const Bytes frame = frame_to_head(0x02, 0x03, Bytes(data_size, 0x55));
    Bytes stream = frame;
    stream.insert(stream.begin() + 5, 'A');
    for (std::size_t cut = 1; cut < stream.size(); ++cut) {
      FrameBuffer buffer{1006};
      std::vector<Bytes> found;
      for (const Bytes& piece : {Bytes(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(cut)),
                                 Bytes(stream.begin() + static_cast<std::ptrdiff_t>(cut), stream.end())}) {
        buffer.append({}, piece);
        std::ranges::move(frames_in(buffer, {}), std::back_inserter(found));
      }
      EXPECT_EQ(found, std::vector<Bytes>{frame}) << data_size << " bytes of data, cut after " << cut;
      EXPECT_EQ(buffer.dropped(), 1U);
    }
  }
}

TEST(FrameBuffer, TakesAFrameThatWasCutAfter100MsOfSilence) {
  FrameBuffer buffer{max_command_frame_size};
  buffer.append(1s, cut_reboot);
  ASSERT_EQ(buffer.next_deadline(), 1100ms);
  EXPECT_FALSE(buffer.front(1099ms));
  const auto frame = buffer.front(1100ms);
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->cut);
  EXPECT_EQ(Bytes(frame->bytes.begin(), frame->bytes.end()), cut_reboot);
  buffer.pop();
  EXPECT_FALSE(buffer.front(2s));
  EXPECT_EQ(buffer.next_deadline(), std::nullopt);
}

TEST(FrameBuffer, NewBytesPutTheSilenceOffAndShowWhatWasCut) {
  FrameBuffer buffer{max_command_frame_size};
  buffer.append(0ms, cut_reboot);
  const Bytes next = load_fixture("send_version");
  buffer.append(90ms, std::span{next}.first(3));
  EXPECT_FALSE(buffer.front(150ms)) << "does not end in a line feed";
  buffer.append(151ms, std::span{next}.subspan(3));
  EXPECT_EQ(frames_in(buffer, 151ms), std::vector<Bytes>{next}) << "18 bytes do not end in a line feed";
  EXPECT_EQ(buffer.dropped(), cut_reboot.size());
}

TEST(FrameBuffer, KeepsAnUnfinishedFrameForEverUnlessItEndsInALineFeed) {
  const Bytes frame = load_fixture("head_command_uxv");
  FrameBuffer buffer{max_command_frame_size};
  buffer.append(0s, std::span{frame}.first(40));
  EXPECT_EQ(buffer.next_deadline(), std::nullopt);
  EXPECT_FALSE(buffer.front(1h));
  buffer.append(1h, std::span{frame}.subspan(40));
  EXPECT_EQ(frames_in(buffer, 1h), std::vector<Bytes>{frame});
}

TEST(FrameBuffer, RejectedFrameLosesOneByteAndWhatIsInsideComesOut) {
  const Bytes inner = load_fixture("reboot");
  const Bytes outer = load_fixture("head_command_uxv");
  FrameBuffer buffer{max_command_frame_size};
  buffer.append(0s, Bytes(outer.begin(), outer.begin() + 20) + inner);
  EXPECT_FALSE(buffer.front(99ms));
  const auto cut = buffer.front(100ms);
  ASSERT_TRUE(cut && cut->cut);
  buffer.reject();
  const auto whole = buffer.front(100ms);
  ASSERT_TRUE(whole);
  EXPECT_FALSE(whole->cut);
  EXPECT_EQ(Bytes(whole->bytes.begin(), whole->bytes.end()), inner);
}

TEST(FrameBuffer, ForgetsWhenTold) {
  const Bytes frame = load_fixture("send_version");
  FrameBuffer buffer{max_command_frame_size};
  buffer.append(0s, std::span{frame}.first(9));
  buffer.clear();
  buffer.append(0s, std::span{frame}.subspan(9));
  EXPECT_FALSE(buffer.front(0s));
}

}  // namespace
}  // namespace sonard::micron::testing
