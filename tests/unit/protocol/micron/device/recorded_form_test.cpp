// SPDX-License-Identifier: Apache-2.0
// How a Micron sends a line from a log, and which differences from the request are reported.
#include "protocol/micron/recorded_form.hpp"

#include <algorithm>
#include <iterator>

#include "bench.hpp"
#include "protocol/micron/line_job.hpp"

namespace sonard::micron {
namespace {

std::vector<std::string> texts(const std::vector<Difference>& found) {
  std::vector<std::string> texts;
  std::ranges::transform(found, std::back_inserter(texts), &Difference::text);
  return texts;
}

TEST(RecordedLine, IsReadAsItWasWritten) {
  const Bytes bins{1, 2, 3};
  HeadData line;
  line.status = head_status_bits::eight_bit;
  line.sweep = SweepCode::right_limit;
  line.control = 0x2305;
  line.range_scale = 0x4123;
  line.tx_word = 0x05666666;
  line.gain = 84;
  line.slope = 125;
  line.ad_span = 81;
  line.ad_low = 8;
  line.heading_offset = 3;
  line.ad_interval = 104;
  line.left_limit = 2500;
  line.right_limit = 3900;
  line.step = 88;
  line.bearing = 3112;
  line.data = bins;
  const Bytes wire = recorded_wire(line, 9);
  EXPECT_EQ(frame_header(wire).tx_node, 9);
  line.data = {};
  EXPECT_EQ(recorded_line(wire), line) << "without its data";
}

TEST(RecordedLine, IsNoOtherMessageAndNoPieceOfOne) {
  EXPECT_FALSE(recorded_line({}));
  EXPECT_FALSE(recorded_line(fixture("version_data")));
  EXPECT_FALSE(recorded_line(fixture("alive_8a")));
  Bytes piece = recorded_wire(HeadData{}, 2);
  EXPECT_TRUE(recorded_line(piece));
  piece.resize(30);
  EXPECT_FALSE(recorded_line(piece));
}

TEST(RecordedLine, OfAWholeLineLeavesItsDataOut) {
  const Bytes frame = fixture("head_data");
  const auto line = recorded_line(frame);
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->data.empty()) << "it would view a buffer that may be gone";
  EXPECT_EQ(line->bearing, 3232);
}

TEST(LineDifferences, TheSameIsNoDifferenceAndEachKindIsTold) {
  ReplayedPing recorded;
  recorded.settings.bins = 400;
  recorded.settings.sound_speed_mps = 1500.0;
  HeadData line;
  line.control = 0x2307;
  line.ad_interval = 53;
  line.gain = 105;
  line.step = 32;
  const PingJob sent = make_line_job(recorded, line);
  HeadCommand asked;
  EXPECT_TRUE(differences(asked, sent, line).empty());
  asked.control = 0x2324;  // 4 bits, a sector, no transmission
  asked.ad_interval = 106;
  asked.bins = 800;
  asked.gain[0] = 210;
  asked.step = 8;
  EXPECT_EQ(texts(differences(asked, sent, line)),
            (std::vector<std::string>{"range 40.70 m requested, 10.18 m sent", "800 bins requested, 400 sent",
                                      "gain 80.0 dB requested, 40.0 dB sent", "4 bits requested, 8 bits sent",
                                      "sector -45.0 to 44.9 degrees requested, all round sent",
                                      "step 8 requested, 32 sent (1/16 gradian)",
                                      "listening only requested, a line with its echoes sent"}));
}

}  // namespace
}  // namespace sonard::micron
