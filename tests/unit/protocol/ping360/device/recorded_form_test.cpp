// SPDX-License-Identifier: Apache-2.0
// How a Ping360 sends a ping from a log, and which differences from the request are reported.
#include "protocol/ping360/recorded_form.hpp"

#include "bench.hpp"
#include "protocol/ping360/make_job.hpp"

namespace sonard::ping360 {
namespace {

std::vector<std::string> texts(const std::vector<Difference>& found) {
  std::vector<std::string> texts;
  std::ranges::transform(found, std::back_inserter(texts), &Difference::text);
  return texts;
}

TEST(Ping360RecordedForm, IsReadAsItWasWritten) {
  const PingForm alone = form_of(Transducer{.gain_setting = 2, .angle = 77, .number_of_samples = 300});
  EXPECT_EQ(recorded_form(recorded_wire(alone, 9)), alone);
  EXPECT_EQ(frame_header(recorded_wire(alone, 9)).source, 9);
  const PingForm of_scan = form_of(scan_of(350, 20, 3), 12);
  EXPECT_EQ(recorded_form(recorded_wire(of_scan, 2)), of_scan);
}

TEST(Ping360RecordedForm, IsNoOtherMessageAndNoPieceOfOne) {
  EXPECT_FALSE(recorded_form({}));
  EXPECT_FALSE(recorded_form(fixture("ack_motor_off")));
  Bytes piece = recorded_wire(PingForm{}, 2);
  EXPECT_TRUE(recorded_form(piece));
  piece.resize(16);
  EXPECT_FALSE(recorded_form(piece));
}

TEST(Ping360RecordedForm, OfAWholePingLeavesItsDataOut) {
  const Bytes frame = fixture("device_data");
  const auto form = recorded_form(frame);
  ASSERT_TRUE(form);
  EXPECT_TRUE(form->settings.data.empty()) << "it would view a buffer that may be gone";
  EXPECT_EQ(form->settings.angle, 200);
}

TEST(Ping360Differences, TheSameIsNoDifferenceAndEachKindIsTold) {
  ReplayedPing recorded;
  recorded.settings.bins = 200;
  recorded.settings.sound_speed_mps = 1500.0;
  const PingForm form = form_of(ping_at(7));
  const PingJob sent = make_job(recorded, form, {});
  EXPECT_TRUE(differences(form, sent, form).empty());
  const PingForm asked = form_of(Transducer{.gain_setting = 1,
                                            .angle = 8,
                                            .transmit_duration_us = 50,
                                            .sample_period = 888,
                                            .transmit_frequency_khz = 800,
                                            .number_of_samples = 1200});
  EXPECT_EQ(
      texts(differences(asked, sent, form)),
      (std::vector<std::string>{"range 19.98 m requested, 0.30 m sent", "1200 samples requested, 200 sent",
                                "gain 1 requested, 0 sent", "pulse of 50 us requested, 32 us sent",
                                "800 kHz requested, 740 kHz sent", "angle 8 requested, angle 7 sent"}));
  const auto of_scan = differences(form_of(scan_of(0, 399), 8), sent, form);
  ASSERT_EQ(of_scan.size(), 1U);
  EXPECT_EQ(of_scan[0].kind, "scan");
  EXPECT_EQ(of_scan[0].text, "scan 0 to 399 gradians, step 1 requested, angle 7 sent");
}

}  // namespace
}  // namespace sonard::ping360
