// SPDX-License-Identifier: Apache-2.0
// Images of sonard's own log, and the summary of such a log.
#include <gtest/gtest.h>

#include "protocol/log/log_messages.hpp"
#include "protocol/mcap/writer.hpp"
#include "protocol/micron/codec.hpp"
#include "protocol/micron/recorded_form.hpp"
#include "server/devices/types/types.hpp"
#include "server/logs/log_summary.hpp"
#include "server/logs/mcap_log_reader.hpp"
#include "tests/unit/server/logs/temporary_log.hpp"

namespace sonard::server {
namespace {

constexpr std::int64_t start_ns = 1'795'184'553'000'000'000;

log::SonarImage image(std::uint64_t number) {
  log::SonarImage image;
  image.set_head("bow");
  image.set_device_id(600);
  image.set_ping_number(number);
  image.set_transmit_time_ns(start_ns + static_cast<std::int64_t>(number) * 100'000'000);
  image.set_range_lines(3);
  image.set_beams(2);
  image.set_pixels(std::string{'a', 'b', 'c', 'd', 'e', static_cast<char>(number)});
  image.add_bearings_rad(0.5);
  image.add_bearings_rad(-0.5);
  image.set_metres_per_line(0.25);
  image.set_sound_speed_mps(1500.0);
  image.set_gain_percent(40.0);
  image.set_frequency_hz(723'380.0);
  return image;
}

log::ScanLine line(std::uint64_t number) {
  log::ScanLine line;
  line.set_head("mast");
  line.set_device_id(2);
  line.set_transmit_time_ns(start_ns + static_cast<std::int64_t>(number) * 50'000'000);
  line.set_bins(std::string(200, 'x'));
  line.set_metres_per_bin(0.05);
  line.set_sound_speed_mps(1500.0);
  return line;
}

struct McapLog {
  mcap::Writer writer{"test", 1000};
  std::uint16_t images, lines, poses;

  McapLog() {
    images = channel(*log::SonarImage::descriptor(), "/bow/image");
    lines = channel(*log::ScanLine::descriptor(), "/mast/line");
    poses = channel(*log::PoseUsed::descriptor(), "/poses");
  }
  std::uint16_t channel(const google::protobuf::Descriptor& message, const std::string& topic) {
    return writer.add_channel(
        writer.add_schema(message.full_name(), log::encoding_name, log::schema_data(message)), topic,
        log::encoding_name);
  }
  void add(std::uint16_t to, std::int64_t time_ns, const google::protobuf::MessageLite& message) {
    const auto time = static_cast<std::uint64_t>(time_ns);
    writer.add_message(to, time, time, log::encode(message));
  }
};

/// Five images, of which number 2 is written last, seven lines and a pose.
McapLog small_log() {
  McapLog log;
  for (const std::uint64_t number : {0, 1, 3, 4, 2}) {
    log.add(log.images, start_ns + 1, image(number));
  }
  for (std::uint64_t number = 0; number < 7; ++number) {
    log.add(log.lines, start_ns + 2, line(number));
  }
  log.add(log.poses, start_ns + 900'000'000, log::PoseUsed{});
  return log;
}

std::vector<std::uint8_t> bytes_of(McapLog& log) {
  log.writer.finish();
  return log.writer.take().append;
}

TEST(McapLogReader, HasEveryImageInTheOrderOfTime) {
  McapLog log = small_log();
  const test::TemporaryLog temporary(".mcap", bytes_of(log));
  const LogFile file(temporary.path());
  const McapLogReader recording(file);
  ASSERT_EQ(recording.heads().size(), 2U) << "and one of lines";
  const LoggedHead& head = recording.heads()[0];
  EXPECT_EQ(head.name, "bow");
  EXPECT_EQ(head.device_id, 600);
  EXPECT_FALSE(head.scanning);
  EXPECT_EQ(head.bearings_rad, (std::vector<double>{-0.5, 0.5})) << "to starboard";
  ASSERT_EQ(head.pings.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(head.pings[i].time_ns, start_ns + static_cast<std::int64_t>(i) * 100'000'000);
    EXPECT_EQ(recording.samples(head.pings[i]),
              (std::vector<std::uint8_t>{'a', 'b', 'c', 'd', 'e', static_cast<std::uint8_t>(i)}));
  }
  EXPECT_EQ(head.pings[0].settings.bins, 3);
  EXPECT_EQ(head.pings[0].settings.beams, 2);
  EXPECT_EQ(head.pings[0].settings.range_m(), 0.75);
  EXPECT_EQ(head.pings[0].bits_per_bin, 8);
  EXPECT_TRUE(head.pings[0].wire.empty());
  EXPECT_TRUE(recording.closed());
  EXPECT_TRUE(recording.problems().empty());
}

TEST(McapLogReader, ImagesThatMakeNoSenseAreLeftOutAndTold) {
  McapLog log = small_log();
  log::SonarImage wrong = image(9);
  wrong.set_range_lines(4);  // 6 pixels instead of 8
  log.add(log.images, start_ns, wrong);
  const test::TemporaryLog temporary(".mcap", bytes_of(log));
  const LogFile file(temporary.path());
  const McapLogReader recording(file);
  EXPECT_EQ(recording.heads().at(0).pings.size(), 5U);
  EXPECT_EQ(recording.problems(), (std::vector<std::string>{"1 images cannot be decoded and are left out"}));
}

TEST(McapLogReader, SummaryCountsAllKinds) {
  McapLog log = small_log();
  const test::TemporaryLog temporary(".mcap", bytes_of(log));
  const LogSummary summary = summarise(LogFile(temporary.path()), &ping_in, &open_packet_log);
  EXPECT_EQ(summary.kind, LogKind::mcap);
  EXPECT_EQ(summary.closed, true);
  EXPECT_FALSE(summary.local_time);
  ASSERT_EQ(summary.heads.size(), 2U);
  EXPECT_FALSE(summary.heads[0].scanning);
  EXPECT_EQ(summary.heads[0].pings(), 5U);
  EXPECT_EQ(summary.heads[0].settings.at(0).settings.frequency_hz, 723'380.0);
  EXPECT_TRUE(summary.heads[1].scanning);
  EXPECT_EQ(summary.heads[1].id, 2);
  EXPECT_EQ(summary.heads[1].pings(), 7U);
  EXPECT_EQ(summary.heads[1].settings.at(0).settings.range_m(), 10.0);
  EXPECT_EQ(summary.other_records,
            (std::vector<std::pair<std::string, std::uint64_t>>{{"sonard.log.PoseUsed messages", 1}}));
  EXPECT_EQ(summary.span_ns, (std::pair{start_ns, start_ns + 900'000'000}));
}

TEST(McapLogReader, HasEveryScanLineAndHowItTravelled) {
  McapLog log;
  micron::HeadData travelled;
  travelled.control = 0x2304;
  travelled.range_scale = 123;
  travelled.bearing = 4800;
  const std::vector<std::uint8_t> frame = micron::encode(micron::Report{travelled});
  for (const std::uint64_t number : {1, 0}) {
    log::ScanLine said = line(number);
    said.set_bearing_rad(-1.5);
    said.set_bins(std::string{1, static_cast<char>(number), 15});
    said.set_bits_per_bin(4);
    said.set_wire_line(std::string(frame.begin(), frame.end()));
    log.add(log.lines, start_ns, said);
  }
  log.add(log.lines, start_ns, line(2));  // without a wire line
  log::ScanLine wrong = line(3);
  wrong.set_metres_per_bin(0.0);
  log.add(log.lines, start_ns, wrong);
  const test::TemporaryLog temporary(".mcap", bytes_of(log));
  const LogFile file(temporary.path());
  const McapLogReader recording(file);
  ASSERT_EQ(recording.heads().size(), 1U);
  const LoggedHead& scan = recording.heads()[0];
  EXPECT_EQ(scan.name, "mast");
  EXPECT_EQ(scan.device_id, 2);
  EXPECT_TRUE(scan.scanning);
  EXPECT_TRUE(scan.bearings_rad.empty());
  ASSERT_EQ(scan.pings.size(), 3U);
  for (std::uint8_t i = 0; i < 2; ++i) {
    const LoggedPing& read = scan.pings[i];
    EXPECT_EQ(read.time_ns, start_ns + i * 50'000'000);
    EXPECT_EQ(recording.samples(read), (std::vector<std::uint8_t>{1, i, 15}));
    EXPECT_EQ(read.settings.bins, 3);
    EXPECT_EQ(read.settings.beams, 1);
    EXPECT_EQ(read.bearing_rad, 1.5) << "to starboard";
    EXPECT_EQ(read.bits_per_bin, 4);
    EXPECT_EQ(read.wire, frame);
    EXPECT_EQ(micron::recorded_line(read.wire), travelled);
  }
  EXPECT_EQ(scan.pings[2].bits_per_bin, 8);
  EXPECT_TRUE(scan.pings[2].wire.empty());
  EXPECT_EQ(recording.problems(),
            (std::vector<std::string>{"1 scan lines cannot be decoded and are left out"}));
}

TEST(McapLogReader, SaysWhichDevicesItsHeadsWere) {
  McapLog log;
  log::SonarImage said = image(0);
  said.set_type("gemini_720i");
  log.add(log.images, start_ns, said);
  log::SonarImage other = image(1);
  other.set_head("port");
  other.set_type("blueview_p900");
  log.add(log.images, start_ns, other);
  log.add(log.images, start_ns, [] {
    log::SonarImage silent = image(2);
    silent.set_head("stern");
    return silent;
  }());
  log::ScanLine scanned = line(0);
  scanned.set_type("micron");
  log.add(log.lines, start_ns, scanned);
  const test::TemporaryLog temporary(".mcap", bytes_of(log));
  const LogFile file(temporary.path());
  const McapLogReader recording(file);
  std::vector<std::pair<std::string, std::string>> devices;
  for (const LoggedHead& head : recording.heads()) {
    devices.emplace_back(head.name, head.type);
  }
  const std::vector<std::pair<std::string, std::string>> expected{
      {"bow", "gemini_720i"}, {"port", "blueview_p900"}, {"stern", ""}, {"mast", "micron"}};
  EXPECT_EQ(devices, expected);
  devices.clear();
  for (const HeadSummary& head : summarise(file, &ping_in, &open_packet_log).heads) {
    devices.emplace_back(head.name, head.type);
  }
  EXPECT_EQ(devices, expected);
}

// Names are unique within one daemon, but logs of other programs may hold duplicates.
TEST(McapLogReader, KeepsAFanAndALineOfOneNameAndIdApart) {
  McapLog log;
  log::SonarImage fan = image(0);
  fan.set_head("mast");
  fan.set_device_id(2);
  log.add(log.images, start_ns, fan);
  log.add(log.lines, start_ns, line(0));
  const test::TemporaryLog temporary(".mcap", bytes_of(log));
  const LogFile file(temporary.path());
  const McapLogReader recording(file);
  ASSERT_EQ(recording.heads().size(), 2U);
  EXPECT_FALSE(recording.heads()[0].scanning);
  EXPECT_TRUE(recording.heads()[1].scanning);
  EXPECT_EQ(recording.samples(recording.heads()[0].pings.at(0)).size(), 6U);
  EXPECT_EQ(recording.samples(recording.heads()[1].pings.at(0)).size(), 200U);
  EXPECT_EQ(summarise(file, &ping_in, &open_packet_log).heads.size(), 2U);
}

TEST(McapLogReader, AnUnfinishedOneHasItsWholeChunks) {
  McapLog log = small_log();
  log.writer.end_chunk();
  std::vector<std::uint8_t> bytes = log.writer.take().append;
  bytes.resize(bytes.size() - 20);
  const test::TemporaryLog temporary(".mcap", bytes);
  const LogSummary summary = summarise(LogFile(temporary.path()), &ping_in, &open_packet_log);
  EXPECT_EQ(summary.closed, false);
  EXPECT_FALSE(summary.problems.empty());
}

}  // namespace
}  // namespace sonard::server
