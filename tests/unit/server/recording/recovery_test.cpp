// SPDX-License-Identifier: Apache-2.0
#include "server/recording/recovery.hpp"

#include <algorithm>
#include <memory>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "protocol/glf/dat_index.hpp"
#include "protocol/mcap/reader.hpp"
#include "protocol/pcapng/blocks.hpp"
#include "server/recording/glf_log_writer.hpp"
#include "server/recording/glf_packing.hpp"
#include "server/recording/mcap_log_writer.hpp"
#include "server/recording/pcapng_log_writer.hpp"
#include "tests/support/without_rights.hpp"
#include "tests/unit/server/recording/fixture.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Bytes = std::vector<std::uint8_t>;

constexpr int pings = 3;

// The log of a killed daemon: three pings with a datagram each. An MCAP file has two closed chunks and an
// open one.
struct RecoveryTest : testing::Test {
  /// The lines that recovery writes to the program's log.
  std::string told() {
    std::ostringstream text;
    const auto before = spdlog::default_logger();
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::ostream_sink_mt>(text)));
    recover_logs(folder.path());
    spdlog::set_default_logger(before);
    return text.str();
  }
  test::TemporaryFolder folder;
  RecordingConfig config;
  std::vector<HeadToRecord> heads = test::one_head();
  LogSetting setting{config, heads, {}, 0, "stem"};

  RecoveryTest() { config.directory = folder.path(); }

  template <class Kind, class... Arguments>
  Bytes killed(Arguments... arguments) {
    Kind log(setting, arguments...);
    for (int number = 0; number < pings; ++number) {
      const TimePoint time = TimePoint{1'795'184'553'000'000'000} + number * McapLogWriter::longest_chunk;
      log.write(test::ping_event(static_cast<std::uint64_t>(number), 32, time));
      log.flush(time);
      log.write(test::wire_event(100, time));
      log.flush(time + McapLogWriter::longest_wait);
    }
    path = log.file().path();
    return test::contents(path);
  }

  fs::path path;
};

std::uint64_t messages_in(const Bytes& file) {
  const auto reader = mcap::Reader::open(file);
  EXPECT_TRUE(reader);
  EXPECT_TRUE(reader->finished());
  mcap::MessageCursor cursor = reader->messages();
  std::uint64_t count = 0;
  while (cursor.next()) {
    ++count;
  }
  EXPECT_TRUE(cursor.damaged().empty());
  return count;
}

TEST_F(RecoveryTest, EndsAnMcapFile) {
  killed<McapLogWriter>();
  EXPECT_TRUE(recover_logs(folder.path()).empty());
  EXPECT_EQ(messages_in(test::contents(path)), 2U * pings);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"log_stem.mcap"});
}

// Recovery writes the open chunk again with its true length, so no message is lost.
TEST_F(RecoveryTest, TellsThatNothingIsLostOfALogWithoutEnd) {
  killed<McapLogWriter>();
  EXPECT_THAT(told(), HasSubstr("log_stem.mcap: nothing is lost"));
  killed<GlfLogWriter>(0);
  EXPECT_THAT(told(), HasSubstr(".dat: nothing is lost"));
}

TEST_F(RecoveryTest, TellsTheSizeOfTheRecordThatWasBeingWritten) {
  Bytes whole = killed<McapLogWriter>();
  whole.insert(whole.end(), {5, 200, 0, 0, 0, 0, 0, 0, 0, 1, 2});  // the first 11 bytes of a message
  test::write_file(path, whole);
  EXPECT_THAT(
      told(),
      HasSubstr("log_stem.mcap: all whole records are kept; 11 bytes of an incomplete record are lost"));
}

TEST_F(RecoveryTest, CutsAnMcapFileAnywhere) {
  const Bytes whole = killed<McapLogWriter>();
  std::uint64_t before = 0;
  for (std::size_t size = 200; size < whole.size(); size += 173) {
    test::write_file(path, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
    recover_logs(folder.path());
    const std::uint64_t now = messages_in(test::contents(path));
    EXPECT_GE(now, before);
    before = now;
  }
  EXPECT_GE(before, 2U * pings - 1);
  EXPECT_EQ(folder.names().size(), 1U);
}

TEST_F(RecoveryTest, LeavesAloneWhatItMayNotRead) {
  for (const char* const name : {"log_a.mcap", "log_b.pcapng", "data_c.dat"}) {
    test::write_file(folder.path() / name, {1, 2, 3});
    fs::permissions(folder.path() / name, fs::perms::none);
  }
  fs::permissions(folder.path(), fs::perms::all);
  std::string log;
  {
    const test::WithoutRights nobody;
    log = told();
  }
  for (const char* const name : {"log_a.mcap", "log_b.pcapng", "data_c.dat"}) {
    EXPECT_THAT(log, HasSubstr(std::string("cannot read ") + (folder.path() / name).string() +
                               ": Permission denied"));
  }
  EXPECT_THAT(log, Not(HasSubstr("damaged")));
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"data_c.dat", "log_a.mcap", "log_b.pcapng"}));
}

TEST_F(RecoveryTest, LeavesAloneWhatIsWhole) {
  killed<McapLogWriter>();
  recover_logs(folder.path());
  const Bytes whole = test::contents(path);
  recover_logs(folder.path());
  EXPECT_EQ(test::contents(path), whole);
}

TEST_F(RecoveryTest, CutsACaptureAnywhere) {
  const Bytes whole = killed<PcapngLogWriter>();
  const std::uint64_t all = pcapng::recover(whole)->packets;
  EXPECT_EQ(all, static_cast<std::uint64_t>(pings));
  std::uint64_t before = 0;
  for (std::size_t size = 80; size <= whole.size(); ++size) {
    test::write_file(path, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
    recover_logs(folder.path());
    const Bytes file = test::contents(path);
    const auto left = pcapng::recover(file);
    ASSERT_TRUE(left) << size;
    EXPECT_EQ(left->keep_size, file.size()) << size;
    EXPECT_GE(left->packets, before);
    before = left->packets;
  }
  EXPECT_EQ(before, all);
  EXPECT_EQ(folder.names().size(), 1U);
}

TEST_F(RecoveryTest, NamesADatToBePacked) {
  killed<GlfLogWriter>(0);
  EXPECT_EQ(recover_logs(folder.path()), std::vector<fs::path>{path});
}

TEST_F(RecoveryTest, RemovesADatThatWasPacked) {
  const Bytes dat = killed<GlfLogWriter>(0);
  GlfPacking packing(path, RecordingSync::never);
  while (packing.step()) {
  }
  ASSERT_FALSE(fs::exists(path));
  test::write_file(path, dat);
  EXPECT_TRUE(recover_logs(folder.path()).empty());
  EXPECT_EQ(folder.names(".dat").size(), 0U);
  EXPECT_EQ(folder.names(".glf").size(), 1U);
}

TEST_F(RecoveryTest, KeepsADamagedDatAndAllItsWholeRecords) {
  Bytes dat = killed<GlfLogWriter>(0);
  const glf::DatIndex index = glf::index_dat(glf::PiecewiseBytes(dat));
  ASSERT_EQ(index.records.size(), 3U);
  dat[index.records[1].offset] = 0;  // no record begins with this byte
  test::write_file(path, dat);
  EXPECT_EQ(recover_logs(folder.path()), std::vector<fs::path>{path});
  EXPECT_EQ(test::contents(path.string() + ".damaged"), dat);
  Bytes whole_records = dat;
  const auto second = whole_records.begin() + static_cast<std::ptrdiff_t>(index.records[1].offset);
  whole_records.erase(second, second + static_cast<std::ptrdiff_t>(index.records[1].size));
  EXPECT_EQ(test::contents(path), whole_records);
}

TEST_F(RecoveryTest, SaysWhatADamagedDatLost) {
  Bytes dat = killed<GlfLogWriter>(0);
  const glf::RecordEntry second = glf::index_dat(glf::PiecewiseBytes(dat)).records.at(1);
  dat[second.offset] = 0;
  test::write_file(path, dat);
  EXPECT_THAT(told(), AllOf(HasSubstr("is damaged: its whole records are in a new file; kept unchanged as "),
                            HasSubstr(std::to_string(second.size) + " bytes at byte " +
                                      std::to_string(second.offset))));
}

TEST_F(RecoveryTest, KeepsThePacketsAfterADamagedOne) {
  Bytes file = killed<PcapngLogWriter>();
  std::vector<std::size_t> packets;
  ASSERT_TRUE(pcapng::for_each_block(file, [&](const pcapng::Block& block) {
    if (block.type == static_cast<std::uint32_t>(pcapng::BlockType::enhanced_packet)) {
      packets.push_back(block.offset);
    }
  }));
  ASSERT_EQ(packets.size(), 3U);
  file[packets[1] + 4] ^= 1;     // the length of the second packet
  file.resize(file.size() + 4);  // the next one was being written
  test::write_file(path, file);
  EXPECT_THAT(told(), HasSubstr("its packets are lost"));
  EXPECT_EQ(test::contents(path.string() + ".damaged"), file);
  EXPECT_EQ(pcapng::recover(test::contents(path))->packets, 2U);
}

TEST_F(RecoveryTest, KeepsAnMcapFileWithADamagedChunk) {
  Bytes file = killed<McapLogWriter>();
  const auto chunks = mcap::Reader::open(file)->summary().chunks;
  ASSERT_EQ(chunks.size(), 3U);
  file[chunks[0].offset + 80] ^= 1;
  test::write_file(path, file);
  const std::string log = told();
  const std::uint64_t kept = messages_in(test::contents(path));
  EXPECT_EQ(kept, 3U) << "of the second and the third chunk";
  EXPECT_THAT(
      log, AllOf(HasSubstr("log_stem.mcap is damaged: its whole records are in a new file; kept unchanged"),
                 HasSubstr(std::to_string(chunks[0].length) + " bytes at byte " +
                           std::to_string(chunks[0].offset)),
                 HasSubstr("; " + std::to_string(2U * pings - kept) + " messages are lost")));
  EXPECT_EQ(test::contents(path.string() + ".damaged"), file);
}

TEST_F(RecoveryTest, KeepsAllMessagesOfAnMcapFileWithADamagedStart) {
  const Bytes whole = killed<McapLogWriter>();
  recover_logs(folder.path());
  const Bytes finished = test::contents(path);
  for (const Bytes& file : {whole, finished}) {
    Bytes damaged = file;
    std::fill_n(damaged.begin(), 8, std::uint8_t{0x55});
    test::write_file(path, damaged);
    EXPECT_THAT(told(),
                AllOf(HasSubstr("log_stem.mcap is damaged: its whole records are in a new file"),
                      HasSubstr("the first 8 bytes cannot be read"), HasSubstr("no message is lost")));
    EXPECT_EQ(messages_in(test::contents(path)), 2U * pings);
    const Bytes rebuilt = test::contents(path);
    EXPECT_EQ(Bytes(rebuilt.begin(), rebuilt.begin() + 8), Bytes(whole.begin(), whole.begin() + 8));
  }
  EXPECT_EQ(folder.names(),
            (std::vector<std::string>{"log_stem.mcap", "log_stem.mcap.damaged", "log_stem.mcap.damaged-2"}));
}

// With the section, and then also with the interface that the packets name.
TEST_F(RecoveryTest, KeepsAllPacketsOfACaptureWithADamagedStart) {
  const Bytes whole = killed<PcapngLogWriter>();
  std::vector<std::size_t> ends;
  ASSERT_TRUE(
      pcapng::for_each_block(whole, [&](const pcapng::Block& block) { ends.push_back(block.end()); }));
  for (const std::size_t size : {std::size_t{1}, ends[0], ends[1]}) {
    Bytes damaged = whole;
    std::fill_n(damaged.begin(), size, std::uint8_t{0x55});
    test::write_file(path, damaged);
    const std::size_t told_size = std::max(size, ends[0]);
    EXPECT_THAT(told(),
                AllOf(HasSubstr("is damaged: its whole records are in a new file"),
                      HasSubstr("the first " + std::to_string(told_size) + " bytes cannot be read"),
                      HasSubstr(size < ends[1] ? "no packet is lost" : "names of interfaces are lost")));
    const Bytes file = test::contents(path);
    const auto left = pcapng::recover(file);
    ASSERT_TRUE(left) << size;
    EXPECT_EQ(left->keep_size, file.size());
    EXPECT_EQ(left->packets, static_cast<std::uint64_t>(pings));
    EXPECT_EQ(told(), "") << "the new file is whole";
  }
}

// A wrong length that points beyond the end looks like a record that was being written.
TEST_F(RecoveryTest, KeepsTheChunksAfterAChunkWithAWrongLength) {
  Bytes file = killed<McapLogWriter>();
  const auto chunks = mcap::Reader::open(file)->summary().chunks;
  file[chunks[1].offset + 8] ^= 1;
  test::write_file(path, file);
  recover_logs(folder.path());
  EXPECT_EQ(test::contents(path.string() + ".damaged"), file);
  EXPECT_GE(messages_in(test::contents(path)), 2U * pings - 2);
}

TEST_F(RecoveryTest, KeepsWhatIsNoLogUntouched) {
  const Bytes text{'h', 'e', 'l', 'l', 'o', ' ', 'w', 'o', 'r', 'l', 'd', '.', '.'};
  for (const char* name : {"log_a.mcap", "log_a.pcapng", "data_a.dat", "notes.txt", "log_a.glf"}) {
    test::write_file(folder.path() / name, text);
  }
  EXPECT_TRUE(recover_logs(folder.path()).empty());
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"data_a.dat.damaged", "log_a.glf", "log_a.mcap.damaged",
                                                      "log_a.pcapng.damaged", "notes.txt"}));
  for (const std::string& name : folder.names()) {
    EXPECT_EQ(test::contents(folder.path() / name), text) << name;
  }
}

TEST_F(RecoveryTest, RemovesEmptyFilesAndHalfPackedOnes) {
  for (const char* name : {"log_a.mcap", "log_a.pcapng", "data_a.dat", "log_a.glf.part"}) {
    test::write_file(folder.path() / name, {});
  }
  EXPECT_TRUE(recover_logs(folder.path()).empty());
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace sonard::server
