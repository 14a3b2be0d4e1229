// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/ping_assembly.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace sonard::gemini {
namespace {

PingHead head_of(int lines) {
  PingHead head;
  head.ping_id = 7;
  head.ext_mode = ext_bits::eight_bit;
  head.end_range = static_cast<std::uint16_t>(lines);
  return head;
}

PingLine line_of(int number, std::span<const std::uint8_t> data) {
  PingLine line;
  line.ping_id = 7;
  line.line_id = static_cast<std::uint16_t>(number);
  line.data = data;
  return line;
}

std::vector<std::uint8_t> filled(std::uint8_t value, std::size_t size = beam_count) {
  return std::vector<std::uint8_t>(size, value);
}

TEST(PingAssembly, PutsLinesInTheirPlaceWhateverTheirOrder) {
  PingAssembly assembly(7);
  assembly.set_head(head_of(3));
  for (const int number : {2, 0, 1}) {
    EXPECT_FALSE(assembly.is_complete());
    const auto data = filled(static_cast<std::uint8_t>(10 + number));
    EXPECT_EQ(assembly.add_line(line_of(number, data)), PingAssembly::Added::fresh);
  }
  ASSERT_TRUE(assembly.is_complete());
  const auto samples = assembly.take_samples();
  ASSERT_EQ(samples.u8.size(), 3U * beam_count);
  EXPECT_TRUE(samples.u16.empty());
  EXPECT_EQ(samples.u8.front(), 10);
  EXPECT_EQ(samples.u8[beam_count], 11);
  EXPECT_EQ(samples.u8.back(), 12);
}

TEST(PingAssembly, LinesWaitForTheirHead) {
  PingAssembly assembly(7);
  const auto data = filled(5);
  EXPECT_EQ(assembly.add_line(line_of(1, data)), PingAssembly::Added::fresh);
  EXPECT_EQ(assembly.add_line(line_of(1, data)), PingAssembly::Added::duplicate);
  EXPECT_EQ(assembly.add_line(line_of(9, data)), PingAssembly::Added::fresh);  // line count still unknown
  assembly.set_head(head_of(2));
  EXPECT_EQ(assembly.lines_received(), 1);
  EXPECT_EQ(assembly.missing(0, 2), (std::vector<LineRange>{{0, 1}}));
}

TEST(PingAssembly, NeighboursAreOneRange) {
  PingAssembly assembly(7);
  assembly.set_head(head_of(10));
  const auto data = filled(1);
  for (const int number : {0, 3, 4, 8}) {
    static_cast<void>(assembly.add_line(line_of(number, data)));
  }
  EXPECT_EQ(assembly.missing(0, 10), (std::vector<LineRange>{{1, 2}, {5, 3}, {9, 1}}));
  EXPECT_EQ(assembly.missing(2, 6), (std::vector<LineRange>{{2, 1}, {5, 1}}));
}

TEST(PingAssembly, ReadsSixteenBitSamplesMostSignificantByteFirst) {
  PingHead head = head_of(1);
  head.ext_mode = 0;
  PingAssembly assembly(7);
  assembly.set_head(head);
  std::vector<std::uint8_t> data(2 * beam_count, 0);
  data[0] = 0x12;
  data[1] = 0x34;
  EXPECT_EQ(assembly.add_line(line_of(0, data)), PingAssembly::Added::fresh);
  EXPECT_EQ(assembly.take_samples().u16.at(0), 0x1234);
}

TEST(PingAssembly, UndoesRunLengthCoding) {
  PingHead head = head_of(1);
  head.rle_threshold = 3;
  PingAssembly assembly(7);
  assembly.set_head(head);
  // One sample of 9, one zero, 254 zeros, padding (6.8).
  const std::vector<std::uint8_t> data{9, 1, 0, 254, 0, 0, 0, 0};
  EXPECT_EQ(assembly.add_line(line_of(0, data)), PingAssembly::Added::fresh);
  const auto samples = assembly.take_samples();
  EXPECT_EQ(samples.u8[0], 9);
  EXPECT_EQ(std::accumulate(samples.u8.begin(), samples.u8.end(), 0), 9);
}

TEST(PingAssembly, RefusesLinesThatDoNotFit) {
  PingAssembly assembly(7);
  assembly.set_head(head_of(2));
  EXPECT_EQ(assembly.add_line(line_of(2, filled(1))), PingAssembly::Added::unusable);
  EXPECT_EQ(assembly.add_line(line_of(0, filled(1, beam_count - 1))), PingAssembly::Added::unusable);
  EXPECT_EQ(assembly.lines_received(), 0);
}

TEST(PingAssembly, RefusesHeadsThatAnnounceNoImage) {
  EXPECT_TRUE(is_receivable(head_of(1)));
  EXPECT_FALSE(is_receivable(head_of(0)));
  EXPECT_FALSE(is_receivable(head_of(0x8001)));
  PingHead no_beams = head_of(10);
  no_beams.beams = 0;
  EXPECT_FALSE(is_receivable(no_beams));
  PingHead too_many_beams = head_of(10);
  too_many_beams.beams = 1025;
  EXPECT_FALSE(is_receivable(too_many_beams));
  PingHead channel_data = head_of(10);
  channel_data.ext_mode = 3;
  EXPECT_FALSE(is_receivable(channel_data));
}

}  // namespace
}  // namespace sonard::gemini
