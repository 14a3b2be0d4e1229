// SPDX-License-Identifier: Apache-2.0
#include "server/recording/recorder.hpp"

#include <atomic>
#include <cstdlib>
#include <ctime>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "protocol/glf/log_view.hpp"
#include "protocol/log/log_messages.hpp"
#include "protocol/mcap/reader.hpp"
#include "protocol/pcapng/blocks.hpp"
#include "server/error/error.hpp"
#include "tests/support/wait_for.hpp"
#include "tests/unit/server/recording/fixture.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

constexpr int lines = 200;  // 51 kB of samples

struct RecorderTest : testing::Test {
  test::TemporaryFolder folder;
  RecordingConfig config;
  SteadyClock clock;

  RecorderTest() {
    config.directory = folder.path() / "made" / "by it";
    config.sync = RecordingSync::never;
  }

  std::vector<fs::path> files(const std::string& suffix) const {
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(config.directory)) {
      if (entry.path().string().ends_with(suffix)) {
        found.push_back(entry.path());
      }
    }
    return found;
  }

  // Numbers of the pings in all .glf, found by their pixels.
  std::multiset<std::uint64_t> glf_pings(std::uint64_t most) const {
    std::multiset<std::uint64_t> numbers;
    for (const fs::path& path : files(".glf")) {
      const Bytes bytes = test::contents(path);
      const auto log = glf::LogView::open(bytes);
      EXPECT_TRUE(log && log->index().closed);
      for (const glf::RecordEntry& record : log->index().records) {
        const auto image = log->image(record);
        EXPECT_TRUE(image);
        for (std::uint64_t number = 0; number < most; ++number) {
          if (image->pixels[0] == test::sample(number, 0, 0) &&
              image->pixels[1] == test::sample(number, 0, 1) &&
              image->pixels[300] == test::sample(number, 1, 44)) {
            numbers.insert(number);
          }
        }
      }
    }
    return numbers;
  }
  std::multiset<std::uint64_t> mcap_pings() const {
    std::multiset<std::uint64_t> numbers;
    for (const fs::path& path : files(".mcap")) {
      const Bytes bytes = test::contents(path);
      const auto reader = mcap::Reader::open(bytes);
      EXPECT_TRUE(reader && reader->finished());
      mcap::MessageCursor cursor = reader->messages();
      while (const auto message = cursor.next()) {
        if (reader->summary().channel(message->channel_id)->topic == "/bow/image") {
          numbers.insert(log::decode<log::SonarImage>(message->data)->ping_number());
        }
      }
    }
    return numbers;
  }
  /// Transmit times of all images, minus `period` for each ping.
  std::set<std::int64_t> mcap_begins(std::chrono::nanoseconds period) const {
    std::set<std::int64_t> begins;
    for (const fs::path& path : files(".mcap")) {
      const Bytes bytes = test::contents(path);
      const auto reader = mcap::Reader::open(bytes);
      mcap::MessageCursor cursor = reader->messages();
      while (const auto message = cursor.next()) {
        if (reader->summary().channel(message->channel_id)->topic == "/bow/image") {
          const auto image = log::decode<log::SonarImage>(message->data);
          begins.insert(image->transmit_time_ns() -
                        static_cast<std::int64_t>(image->ping_number()) * period.count());
        }
      }
    }
    return begins;
  }
  std::uint64_t packets() const {
    std::uint64_t count = 0;
    for (const fs::path& path : files(".pcapng")) {
      const Bytes bytes = test::contents(path);
      count += pcapng::recover(bytes)->packets;
    }
    return count;
  }
};

std::multiset<std::uint64_t> numbers_up_to(std::uint64_t count) {
  std::multiset<std::uint64_t> numbers;
  for (std::uint64_t number = 0; number < count; ++number) {
    numbers.insert(number);
  }
  return numbers;
}

TEST_F(RecorderTest, WritesWhatItWasGivenIntoEveryLog) {
  Recorder recorder(config, test::one_head());
  for (std::uint64_t number = 0; number < 10; ++number) {
    recorder.push(test::ping_event(number, lines, clock.now()));
    recorder.push(test::wire_event(100, clock.now()));
  }
  recorder.stop();
  EXPECT_EQ(glf_pings(10), numbers_up_to(10));
  EXPECT_EQ(mcap_pings(), numbers_up_to(10));
  EXPECT_EQ(packets(), 10U);
  EXPECT_EQ(recorder.counters().images, 10U);
  EXPECT_EQ(recorder.counters().logs_written, 3U);
  EXPECT_EQ(recorder.counters().logs_failed, 0U);
  EXPECT_EQ(recorder.counters().dropped.total(), 0U);
}

TEST_F(RecorderTest, WritesOnlyTheKindsThatAreAskedFor) {
  config.mcap = config.pcapng = false;
  Recorder recorder(config, test::one_head());
  recorder.push(test::ping_event(0, lines, clock.now()));
  recorder.stop();
  EXPECT_EQ(files("").size(), 1U);
  EXPECT_EQ(files(".glf").size(), 1U);
}

TEST_F(RecorderTest, WritesTheDatagramsOfAHeadWithPacketLogsAsTheyAre) {
  config.glf = config.mcap = config.pcapng = false;
  std::vector<HeadToRecord> heads = test::one_head();
  heads.push_back({"stern", "other", 0, nullptr, true});
  Recorder recorder(config, heads);
  recorder.push(test::wire_event(10, clock.now()));  // of the head without such logs
  RecordingEvent sent = test::wire_event(0, clock.now());
  sent.head = 1;
  const Endpoint client = std::get<WirePassed>(sent.what).pieces.at(0).client;
  for (const Bytes& bytes : {Bytes{1, 2, 3}, Bytes{4}}) {
    std::get<WirePassed>(sent.what).pieces = {{client, {}, SharedBytes(bytes)}};
    recorder.push(sent);
  }
  std::get<WirePassed>(sent.what).to_client = false;
  recorder.push(sent);
  recorder.stop();
  ASSERT_EQ(files("").size(), 1U);
  ASSERT_EQ(files("_stern.sonar").size(), 1U);
  EXPECT_EQ(test::contents(files("_stern.sonar")[0]), (Bytes{1, 2, 3, 4}));
}

TEST_F(RecorderTest, MakesNoFileWithoutAnEvent) {
  Recorder(config, test::one_head()).stop();
  EXPECT_TRUE(files("").empty());
}

TEST_F(RecorderTest, BeginsNewFilesWhenOneIsFull) {
  config.rotate_bytes = 300'000;
  {
    Recorder recorder(config, test::one_head());
    for (std::uint64_t number = 0; number < 30; ++number) {
      recorder.push(test::ping_event(number, lines, clock.now()));
    }
  }
  EXPECT_GE(files(".glf").size(), 4U);
  EXPECT_EQ(files(".glf").size(), files(".mcap").size());
  for (const fs::path& path : files("")) {
    EXPECT_LT(fs::file_size(path), 300'000U + 60'000U) << path;  // at most one more ping
  }
  EXPECT_EQ(glf_pings(30), numbers_up_to(30));
  EXPECT_EQ(mcap_pings(), numbers_up_to(30));
}

TEST_F(RecorderTest, BeginsNewFilesWhenTimeIsOver) {
  config.rotate_after = std::chrono::minutes{10};
  Recorder recorder(config, test::one_head());
  const TimePoint begin = clock.now();
  for (std::uint64_t number = 0; number < 30; ++number) {  // one per minute
    recorder.push(test::ping_event(number, 32, begin + number * std::chrono::minutes{1}));
  }
  recorder.stop();
  EXPECT_EQ(files(".mcap").size(), 3U);
  EXPECT_EQ(files(".glf").size(), 3U);
  EXPECT_EQ(mcap_pings(), numbers_up_to(30));
}

TEST_F(RecorderTest, TimesHaveOneOffsetInAllFiles) {
  config.rotate_after = std::chrono::minutes{2};
  Recorder recorder(config, test::one_head());
  const TimePoint begin = clock.now();
  for (std::uint64_t number = 0; number < 30; ++number) {
    recorder.push(test::ping_event(number, 32, begin + number * std::chrono::minutes{1}));
  }
  recorder.stop();
  EXPECT_EQ(files(".mcap").size(), 15U);
  EXPECT_EQ(mcap_begins(std::chrono::minutes{1}).size(), 1U);
}

TEST_F(RecorderTest, DropsAndCountsWhatDoesNotFitTheQueue) {
  config.queue_bytes = 200'000;
  Recorder recorder(config, test::one_head());
  constexpr std::uint64_t pushed = 400;
  for (std::uint64_t number = 0; number < pushed; ++number) {
    recorder.push(test::ping_event(number, lines, clock.now()));
  }
  recorder.push(test::ping_event(pushed, 1000, clock.now()));  // never fits
  recorder.stop();
  EXPECT_GE(recorder.counters().dropped.images, 1U);
  EXPECT_EQ(recorder.counters().images + recorder.counters().dropped.images, pushed + 1);
  EXPECT_EQ(mcap_pings().size(), recorder.counters().images);
}

// A thread that saw the recorder turned on may push after the logs were closed. This must open no further
// logs.
TEST_F(RecorderTest, WritesOneLogForEachTimeItIsTurnedOn) {
  constexpr std::uint64_t times = 300;
  config.glf = config.pcapng = false;
  config.queue_bytes = 100000;  // few events, so that the recorder soon finishes them
  Recorder recorder(config, test::one_head());
  std::atomic<bool> ends{false};
  const auto push_pings = [&] {
    while (!ends) {
      recorder.push(test::ping_event(0, 1, clock.now()));
    }
  };
  std::vector<std::thread> heads;
  for (int head = 0; head < 4; ++head) {  // more than most test machines have cores
    heads.emplace_back(push_pings);
  }
  for (std::uint64_t time = 1; time <= times; ++time) {
    const std::uint64_t images = recorder.counters().images;
    recorder.turn(true);
    EXPECT_TRUE(test::wait_for([&] { return recorder.counters().images > images; }));
    recorder.turn(false);
    EXPECT_TRUE(test::wait_for([&] { return recorder.counters().logs_written >= time; }));
  }
  ends = true;
  for (std::thread& head : heads) {
    head.join();
  }
  recorder.stop();
  EXPECT_EQ(recorder.counters().logs_written, times);
  EXPECT_EQ(files(".mcap").size(), times);
}

// If the disk is full for one file, it is soon full for the others too.
TEST_F(RecorderTest, GivesUpFilesThatCannotBeWrittenAndKeepsWhatIsWhole) {
  std::uint64_t lost = 0;
  {
    const test::FileSizeLimit limit(400'000);
    Recorder recorder(config, test::one_head());
    for (std::uint64_t number = 0; number < 20; ++number) {
      recorder.push(test::wire_event(1000, clock.now()));
      recorder.push(test::ping_event(number, lines, clock.now()));
    }
    recorder.stop();
    EXPECT_EQ(recorder.counters().logs_failed, 2U);  // the MCAP file and the .dat
    EXPECT_EQ(recorder.counters().logs_written, 1U);
    EXPECT_EQ(recorder.counters().images, 20U);
    lost = recorder.counters().images_lost;
    EXPECT_EQ(packets(), 20U) << "a small file is not full";
  }
  Recorder(config, test::one_head()).stop();  // now the disk has room again
  const std::multiset<std::uint64_t> kept = glf_pings(20);
  EXPECT_EQ(kept, numbers_up_to(kept.size()));
  EXPECT_GE(kept.size(), 6U);
  EXPECT_LT(kept.size(), 8U);
  EXPECT_EQ(mcap_pings(), numbers_up_to(mcap_pings().size()));
  EXPECT_GE(mcap_pings().size(), 6U);
  EXPECT_EQ(lost, 0U) << "the capture could still be written";
  EXPECT_TRUE(files(".dat").empty());
}

TEST_F(RecorderTest, TriesAgainWithTheNextFiles) {
  config.pcapng = config.glf = false;
  config.rotate_after = std::chrono::minutes{10};
  Recorder recorder(config, test::one_head());
  const TimePoint begin = clock.now();
  {
    const test::FileSizeLimit limit(100'000);
    for (std::uint64_t number = 0; number < 5; ++number) {
      recorder.push(test::ping_event(number, lines, begin));
    }
    ASSERT_TRUE(test::wait_for([&] { return recorder.counters().images == 5; }));
  }
  recorder.push(test::ping_event(5, lines, begin + std::chrono::minutes{11}));
  recorder.stop();
  EXPECT_EQ(recorder.counters().images_lost, 4U);
  EXPECT_EQ(recorder.counters().logs_failed, 1U);
  EXPECT_EQ(recorder.counters().logs_written, 1U);
}

TEST_F(RecorderTest, LocksItsFolder) {
  const Recorder first(config, test::one_head());
  try {
    const Recorder second(config, test::one_head());
    FAIL() << "two recorders share a folder";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(config.directory.string()), std::string::npos);
  }
}

TEST_F(RecorderTest, SaysWhyAFolderCannotBeUsed) {
  test::write_file(folder.path() / "made", {1});
  EXPECT_THROW(Recorder(config, test::one_head()), Error);
}

TEST_F(RecorderTest, NamesAndTimesFollowTheZone) {
  for (const char* zone : {"UTC0", "XYZ-5:30"}) {  // POSIX counts zones to the west
    setenv("TZ", zone, 1);
    tzset();
    config.zone = RecordingZone::local;
    config.directory = folder.path() / zone;
    const double before_s = static_cast<double>(std::time(nullptr)) - 315'532'800.0;
    Recorder recorder(config, test::one_head());
    recorder.push(test::ping_event(0, lines, clock.now()));
    recorder.stop();
    const Bytes bytes = test::contents(files(".glf").front());
    const auto log = glf::LogView::open(bytes);
    const double offset_s = std::string(zone) == "UTC0" ? 0.0 : 5.5 * 3600;
    EXPECT_NEAR(log->index().records.front().origin.time_s, before_s + offset_s, 5.0);
  }
  unsetenv("TZ");
  tzset();
}

}  // namespace
}  // namespace sonard::server
