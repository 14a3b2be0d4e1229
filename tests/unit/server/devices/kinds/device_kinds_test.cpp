// SPDX-License-Identifier: Apache-2.0
// Requirements on every kind of device in the program, and the description of a head for logs.
#include "server/devices/kinds/kinds.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>
#include <boost/asio/io_context.hpp>

#include "renderer/sonar_settings.hpp"
#include "server/net/pty_port.hpp"

namespace sonard::server {
namespace {

TEST(DeviceKinds, HaveNamesOfTheirOwn) {
  std::set<std::string_view> types, titles;
  for (const DeviceKind* kind : device_kinds()) {
    EXPECT_TRUE(types.insert(kind->type()).second) << kind->type();
    EXPECT_TRUE(titles.insert(kind->title()).second) << kind->title();
    EXPECT_EQ(kind_of_type(kind->type()), kind);
  }
  EXPECT_GE(types.size(), 2U);
  EXPECT_EQ(kind_of_type("none"), nullptr);
  EXPECT_EQ(head_kinds().size(), device_kinds().size());
}

TEST(DeviceKinds, MakeAHeadThatCanBeRenderedAndRecorded) {
  for (const DeviceKind* kind : device_kinds()) {
    const HeadConfig head = kind->make_default();
    ASSERT_EQ(head.kind, kind) << kind->type();
    ASSERT_NE(head.device, nullptr) << kind->type();
    const PingJob job = kind->usual_job(head);
    EXPECT_GT(job.bins(), 0) << kind->type();
    EXPECT_GT(job.listening_time.count(), 0) << kind->type();
    const render::SonarSettings settings = usual_settings(head);
    EXPECT_EQ(settings.range.output_count(), job.bins()) << kind->type();
    EXPECT_EQ(settings.aperture.beam_count() == 1, kind->scanning()) << kind->type();
    EXPECT_NO_THROW(check_sampling_of(head)) << kind->type();
    EXPECT_FALSE(kind->summary(head).empty()) << kind->type();
  }
}

// `sonard check` renders the usual ping, and the daemon the pings of clients. A survey without options has
// the settings of `sonarview` without options.
TEST(DeviceKinds, UsualPingIsAsLoudAndLongAsThatOfAClient) {
  for (const DeviceKind* kind : device_kinds()) {
    const HeadConfig head = kind->make_default();
    const PingJob usual = kind->usual_job(head);
    const std::unique_ptr<Survey> survey = kind->survey(head, {});
    survey->frames(1);
    const PingJob asked = survey->job(0);
    EXPECT_EQ(usual.pulse_s, asked.pulse_s) << kind->type();
    EXPECT_EQ(usual.gain_db, asked.gain_db) << kind->type();
    EXPECT_EQ(usual.frequency_hz, asked.frequency_hz) << kind->type();
    EXPECT_EQ(usual.native_bins, asked.native_bins) << kind->type();
    EXPECT_EQ(usual.compression_log2, asked.compression_log2) << kind->type();
    EXPECT_EQ(usual.native_bin_m, asked.native_bin_m) << kind->type();
  }
}

// From docs/protocols: a client of a 720i requests 11 cycles of 723 kHz at 20 m, of a Ping360 at 10 m
// 8000 us * 10 / 1500 = 53 us.
TEST(DeviceKinds, UsualPulsesAreThoseOfTheDocuments) {
  const auto pulse_s = [](const char* type) {
    const DeviceKind& kind = *kind_of_type(type);
    return kind.usual_job(kind.make_default()).pulse_s;
  };
  EXPECT_NEAR(pulse_s("gemini_720i"), 11 / 723e3, 1e-8);
  EXPECT_NEAR(pulse_s("ping360"), 53e-6, 1e-9);
}

TEST(DeviceKinds, NameThePtyLinkThatCannotBeMade) {
  PtyLinkError link("cannot create the link");
  link.item = 2;
  for (const DeviceKind* kind : device_kinds()) {
    EXPECT_EQ(trouble_of(link, *kind).key, "serial.pty[2].link");
    EXPECT_FALSE(trouble_of(link, *kind).of_network);
    EXPECT_EQ(trouble_of(SocketError("in use"), *kind).key, kind->socket_key());
    EXPECT_TRUE(trouble_of(SocketError("in use"), *kind).of_network);
  }
}

TEST(DeviceKinds, LayOutASurveyOfWholeFrames) {
  for (const DeviceKind* kind : device_kinds()) {
    const HeadConfig head = kind->make_default();
    const std::unique_ptr<Survey> survey = kind->survey(head, {});
    EXPECT_GT(survey->natural_period().count(), 0) << kind->type();
    EXPECT_GT(survey->client_bin_m(), 0.0) << kind->type();
    const std::vector<int> frames = survey->frames(1000);
    ASSERT_GE(frames.size(), 2U) << kind->type();
    EXPECT_EQ(frames.front(), 0) << kind->type();
    EXPECT_LE(frames.back(), 1000) << kind->type();
    for (std::size_t i = 1; i < frames.size(); ++i) {
      EXPECT_GT(frames[i], frames[i - 1]) << kind->type();
    }
    EXPECT_EQ(survey->job(999).number, 999U) << kind->type();
    EXPECT_EQ(survey->bearings_rad().empty(), kind->scanning()) << kind->type();
  }
}

TEST(RecordedHeads, NumberThoseWhoseUsersKnowGlfLogs) {
  HeadConfig fan = kind_of_type("gemini_720i")->make_default();
  fan.name = "a";
  HeadConfig scanning = kind_of_type("micron")->make_default();
  scanning.name = "b";
  const std::vector<HeadToRecord> recorded = recorded_heads({fan, scanning, fan});
  ASSERT_EQ(recorded.size(), 3U);
  EXPECT_EQ(recorded[0].name, "a");
  EXPECT_EQ(recorded[0].device, "gemini_720i");
  EXPECT_EQ(recorded[0].device_id, 513);
  EXPECT_EQ(recorded[0].glf_number, 0);
  EXPECT_EQ(recorded[1].device_id, 2);
  EXPECT_FALSE(recorded[1].glf_number);
  EXPECT_EQ(recorded[2].glf_number, 1);
}

}  // namespace
}  // namespace sonard::server
