// SPDX-License-Identifier: Apache-2.0
// Requirements on every type of device in the program, and the description of a head for logs.
#include "server/devices/types/types.hpp"

#include <set>
#include <stdexcept>
#include <string>
#include <typeinfo>

#include <gtest/gtest.h>
#include <boost/asio/io_context.hpp>
#include <boost/core/demangle.hpp>

#include "renderer/sonar_settings.hpp"
#include "server/net/pty_port.hpp"
#include "server/recording/glf_device.hpp"

namespace sonard::server {
namespace {

TEST(DeviceTypes, HaveNamesOfTheirOwn) {
  std::set<std::string_view> types, titles;
  for (const DeviceType* type : device_types()) {
    EXPECT_TRUE(types.insert(type->name()).second) << type->name();
    EXPECT_TRUE(titles.insert(type->title()).second) << type->title();
    EXPECT_EQ(type_named(type->name()), type);
  }
  EXPECT_GE(types.size(), 2U);
  EXPECT_EQ(type_named("none"), nullptr);
  EXPECT_EQ(head_types().size(), device_types().size());
}

TEST(DeviceTypes, MakeAHeadThatCanBeRenderedAndRecorded) {
  for (const DeviceType* type : device_types()) {
    const HeadConfig head = type->make_default();
    ASSERT_EQ(head.type, type) << type->name();
    ASSERT_NE(head.device, nullptr) << type->name();
    const PingJob job = type->usual_job(head);
    EXPECT_GT(job.bins(), 0) << type->name();
    EXPECT_GT(job.listening_time.count(), 0) << type->name();
    const render::SonarSettings settings = usual_settings(head);
    EXPECT_EQ(settings.range.output_count(), job.bins()) << type->name();
    if (!job.directions.any()) {
      EXPECT_EQ(settings.aperture.beam_count() == 1, type->scanning()) << type->name();
    }
    EXPECT_NO_THROW(check_sampling_of(head)) << type->name();
    PingJob recorded = job;  // a replayed ping of a head that measures directions has none
    recorded.directions = {};
    EXPECT_FALSE(type->sonar_settings(recorded, head).aperture.beam_edges_rad.empty()) << type->name();
    EXPECT_FALSE(type->summary(head).empty()) << type->name();
  }
}

// `sonard check` renders the usual ping, and the daemon the pings of clients. A survey without options has
// the settings of `sonarview` without options.
TEST(DeviceTypes, UsualPingIsAsLoudAndLongAsThatOfAClient) {
  for (const DeviceType* type : device_types()) {
    const HeadConfig head = type->make_default();
    const PingJob usual = type->usual_job(head);
    const std::unique_ptr<Survey> survey = type->survey(head, {});
    survey->frames(1);
    const PingJob asked = survey->job(0);
    EXPECT_EQ(usual.pulse_s, asked.pulse_s) << type->name();
    EXPECT_EQ(usual.gain_db, asked.gain_db) << type->name();
    EXPECT_EQ(usual.frequency_hz, asked.frequency_hz) << type->name();
    EXPECT_EQ(usual.native_bins, asked.native_bins) << type->name();
    EXPECT_EQ(usual.compression_log2, asked.compression_log2) << type->name();
    EXPECT_EQ(usual.native_bin_m, asked.native_bin_m) << type->name();
  }
}

// From the protocol pages: a client of a 720i requests 11 cycles of 723 kHz at 20 m, of a Ping360 at 10 m
// 8000 us * 10 / 1500 = 53 us.
TEST(DeviceTypes, UsualPulsesAreThoseOfTheDocuments) {
  const auto pulse_s = [](const char* name) {
    const DeviceType& type = *type_named(name);
    return type.usual_job(type.make_default()).pulse_s;
  };
  EXPECT_NEAR(pulse_s("gemini_720i"), 11 / 723e3, 1e-8);
  EXPECT_NEAR(pulse_s("ping360"), 53e-6, 1e-9);
}

TEST(DeviceTypes, RefuseTheSettingsOfAnotherType) {
  const auto types = device_types();
  for (std::size_t i = 0; i < types.size(); ++i) {
    HeadConfig head = types[i]->make_default();
    const DeviceSettings& own = *head.device;
    const std::string own_name = boost::core::demangle(typeid(own).name());
    head.device = types[(i + 1) % types.size()]->make_default().device;
    const DeviceSettings& other = *head.device;
    const std::string other_name = boost::core::demangle(typeid(other).name());
    try {
      types[i]->device_id(head);
      ADD_FAILURE() << types[i]->name();
    } catch (const std::logic_error& error) {
      EXPECT_EQ(error.what(), "expected " + own_name + ", got " + other_name);
    }
    head.device = nullptr;
    EXPECT_THROW(types[i]->device_id(head), std::logic_error) << types[i]->name();
  }
}

TEST(DeviceTypes, NameThePtyLinkThatCannotBeMade) {
  PtyLinkError link("cannot create the link");
  link.item = 2;
  for (const DeviceType* type : device_types()) {
    EXPECT_EQ(trouble_of(link, *type).key, "serial.pty[2].link");
    EXPECT_FALSE(trouble_of(link, *type).of_network);
    EXPECT_EQ(trouble_of(SocketError("in use"), *type).key, type->socket_key());
    EXPECT_TRUE(trouble_of(SocketError("in use"), *type).of_network);
  }
}

TEST(DeviceTypes, LayOutASurveyOfWholeFrames) {
  for (const DeviceType* type : device_types()) {
    const HeadConfig head = type->make_default();
    const std::unique_ptr<Survey> survey = type->survey(head, {});
    EXPECT_GT(survey->natural_period().count(), 0) << type->name();
    EXPECT_GT(survey->client_bin_m(), 0.0) << type->name();
    const std::vector<int> frames = survey->frames(1000);
    ASSERT_GE(frames.size(), 2U) << type->name();
    EXPECT_EQ(frames.front(), 0) << type->name();
    EXPECT_LE(frames.back(), 1000) << type->name();
    for (std::size_t i = 1; i < frames.size(); ++i) {
      EXPECT_GT(frames[i], frames[i - 1]) << type->name();
    }
    EXPECT_EQ(survey->job(999).number, 999U) << type->name();
    EXPECT_EQ(survey->bearings_rad().empty(), type->scanning()) << type->name();
  }
}

TEST(RecordedHeads, NameTheTypeWhoseUsersKnowGlfLogs) {
  HeadConfig fan = type_named("gemini_720i")->make_default();
  fan.name = "a";
  HeadConfig scanning = type_named("micron")->make_default();
  scanning.name = "b";
  const std::vector<HeadToRecord> recorded = recorded_heads({fan, scanning, fan});
  ASSERT_EQ(recorded.size(), 3U);
  EXPECT_EQ(recorded[0].name, "a");
  EXPECT_EQ(recorded[0].type, "gemini_720i");
  EXPECT_EQ(recorded[0].device_id, 513);
  EXPECT_EQ(recorded[0].glf, glf_device(*fan.type));
  ASSERT_NE(recorded[0].glf, nullptr);
  EXPECT_EQ(recorded[1].device_id, 2);
  EXPECT_EQ(recorded[1].glf, nullptr);
  EXPECT_EQ(recorded[2].glf, recorded[0].glf);
}

}  // namespace
}  // namespace sonard::server
