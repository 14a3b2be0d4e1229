// SPDX-License-Identifier: Apache-2.0
// Logs with one wrong bit, at every byte: a damaged part loses its own pings and no others. The expected
// values are the pings written into the undamaged log.
#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/glf/codec.hpp"
#include "protocol/glf/headers.hpp"
#include "protocol/glf/packer.hpp"
#include "protocol/log/log_messages.hpp"
#include "protocol/mcap/writer.hpp"
#include "protocol/pcapng/blocks.hpp"
#include "server/logs/log_reader.hpp"
#include "server/logs/log_summary.hpp"
#include "tests/unit/server/logs/temporary_log.hpp"

namespace sonard::server {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::AllOf;
using testing::AnyOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Samples of each ping by its number.
using Pings = std::map<int, std::string>;

std::string samples_of(int number) {
  std::string samples;
  for (int i = 0; i < 60; ++i) {
    samples += static_cast<char>((31 * number + 7 * i * i) % 251);
  }
  return samples;
}

Pings pings_written(int count) {
  Pings pings;
  for (int number = 0; number < count; ++number) {
    pings[number] = samples_of(number);
  }
  return pings;
}

constexpr std::int64_t first_ping_ns = 1'795'184'553'000'000'000;
constexpr std::int64_t ping_interval_ns = 100'000'000;

/// A log with two images per chunk.
Bytes mcap_log(int images, bool compressed, bool finished) {
  mcap::Writer writer{"test", 100'000, compressed ? mcap::Compression::zstd : mcap::Compression::none};
  const auto schema = writer.add_schema("sonard.log.SonarImage", log::encoding_name, Bytes{1, 2, 3});
  const auto channel = writer.add_channel(schema, "/bow/image", log::encoding_name);
  for (int number = 0; number < images; ++number) {
    log::SonarImage image;
    image.set_head("bow");
    image.set_device_id(600);
    image.set_transmit_time_ns(first_ping_ns + number * ping_interval_ns);
    image.set_range_lines(20);
    image.set_beams(3);
    image.set_pixels(samples_of(number));
    for (const double bearing : {0.5, 0.0, -0.5}) {
      image.add_bearings_rad(bearing);
    }
    image.set_metres_per_line(0.25);
    image.set_sound_speed_mps(1500.0);
    const auto time = static_cast<std::uint64_t>(image.transmit_time_ns());
    writer.add_message(channel, time, time, log::encode(image));
    if (number % 2 == 1) {
      writer.end_chunk();
    }
  }
  if (finished) {
    writer.finish();
  } else {
    writer.flush();
  }
  return writer.take().append;
}

glf::ImageRecord glf_image(int number) {
  glf::ImageRecord image;
  image.origin = {.time_s = 1000.0 + number, .device_id = 600, .node_id = 1};
  image.lines = 20;
  image.beams = 3;
  const std::string samples = samples_of(number);
  image.pixels.assign(samples.begin(), samples.end());
  image.bearings_rad = {0.5, 0.0, -0.5};
  image.transmit_time_s = 1000.0 + number;
  image.modulation_frequency_hz = 3000;
  image.sound_speed_mps = 1500.0F;
  return image;
}

Bytes dat_log(int images) {
  Bytes dat;
  for (int number = 0; number < images; ++number) {
    const Bytes record = glf::encode(glf_image(number));
    dat.insert(dat.end(), record.begin(), record.end());
  }
  dat.insert(dat.end(), glf::dat_terminator.begin(), glf::dat_terminator.end());
  return dat;
}

Bytes glf_log(int images, std::size_t block_size = glf::pack_block_size) {
  const Bytes dat = dat_log(images);
  const glf::CivilTime closed{.year = 2026, .month = 11, .day = 20, .hour = 14, .minute = 22, .second = 33};
  // ZIP and MCAP use the same CRC.
  const glf::Packer packer{"2026-11-20-142233", "<genesisLog/>\n", {dat.size(), mcap::crc32(dat)}, closed};
  Bytes archive = packer.head();
  for (std::span<const std::uint8_t> rest = dat; !rest.empty();) {
    const auto block = rest.first(std::min(block_size, rest.size()));
    const auto header = glf::Packer::block_header(block.size());
    archive.insert(archive.end(), header.begin(), header.end());
    archive.insert(archive.end(), block.begin(), block.end());
    rest = rest.subspan(block.size());
  }
  const auto tail = packer.tail();
  archive.insert(archive.end(), tail.begin(), tail.end());
  return archive;
}

Bytes::iterator place_of(const std::string& samples, Bytes& in) {
  const Bytes bytes(samples.begin(), samples.end());
  return std::search(in.begin(), in.end(), bytes.begin(), bytes.end());
}

struct Outcome {
  bool opened = false;
  std::size_t pings = 0;  ///< pings with readable samples
  std::size_t lost = 0;   ///< written pings whose samples were not read
  std::vector<std::string> problems;
};

Outcome outcome_of(const std::string& suffix, const Bytes& bytes, const Pings& written) {
  Outcome outcome;
  const test::TemporaryLog temporary(suffix, bytes);
  std::vector<std::string> read;
  try {
    const LogFile file(temporary.path());
    const auto recording = open_log(file, {});
    for (const LoggedHead& head : recording->heads()) {
      for (const LoggedPing& ping : head.pings) {
        try {
          const auto samples = recording->samples(ping);
          read.emplace_back(samples.begin(), samples.end());
        } catch (const Error&) {
        }
      }
    }
    outcome.problems = summarise(file, [](auto) { return std::nullopt; }, {}).problems;
    outcome.opened = true;
  } catch (const Error& error) {
    outcome.problems.emplace_back(error.what());
  }
  outcome.pings = read.size();
  for (const auto& [number, samples] : written) {
    outcome.lost += std::ranges::find(read, samples) == read.end() ? 1 : 0;
  }
  return outcome;
}

/// Flips each bit in turn. Each flip may lose at most `most_lost` pings, and a loss must be reported.
void expect_at_most(std::size_t most_lost, const std::string& suffix, const Bytes& whole,
                    const Pings& written) {
  const Outcome undamaged = outcome_of(suffix, whole, written);
  ASSERT_EQ(undamaged.lost, 0U);
  std::size_t flips_that_lose = 0;
  for (std::size_t flip = 0; flip < 8 * whole.size(); ++flip) {
    const std::size_t at = flip / 8;
    Bytes damaged = whole;
    damaged[at] ^= static_cast<std::uint8_t>(1U << flip % 8);
    const Outcome outcome = outcome_of(suffix, damaged, written);
    ASSERT_TRUE(outcome.opened) << "byte " << at << ": " << outcome.problems.at(0);
    ASSERT_LE(outcome.lost, most_lost) << "byte " << at << ": " << testing::PrintToString(outcome.problems);
    if (outcome.pings < written.size()) {
      ASSERT_GT(outcome.problems.size(), undamaged.problems.size()) << "a loss is said: byte " << at;
    }
    if (outcome.lost == 0) {
      ASSERT_THAT(outcome.problems, Each(AnyOf(HasSubstr("; no ping is lost"), Not(HasSubstr("lost")))))
          << at;
    }
    flips_that_lose += outcome.lost > 0 ? 1 : 0;
  }
  EXPECT_GT(flips_that_lose, 2 * whole.size()) << "most bytes are those of pings";
}

TEST(Damage, AFlippedBitInAnMcapCostsItsChunk) {
  expect_at_most(2, ".mcap", mcap_log(6, false, true), pings_written(6));
}

TEST(Damage, AFlippedBitInACompressedMcapCostsItsChunk) {
  expect_at_most(2, ".mcap", mcap_log(6, true, true), pings_written(6));
}

TEST(Damage, AFlippedBitInAnMcapThatWasNotClosedCostsItsChunk) {
  expect_at_most(2, ".mcap", mcap_log(7, false, false), pings_written(7));
  expect_at_most(2, ".mcap", mcap_log(6, true, false), pings_written(6));
}

TEST(Damage, EachBitInTheTypeOfAnIndexOfAnMcapThatWasNotClosedCostsNoPing) {
  const Bytes whole = mcap_log(6, false, false);
  constexpr std::uint8_t message_index = 7;
  const Bytes front{message_index, 6 + 2 * 16, 0, 0, 0, 0, 0, 0, 0};
  const auto index = std::search(whole.begin(), whole.end(), front.begin(), front.end());
  ASSERT_NE(index, whole.end());
  for (int bit = 0; bit < 8; ++bit) {
    Bytes damaged = whole;
    damaged[static_cast<std::size_t>(index - whole.begin())] ^= static_cast<std::uint8_t>(1U << bit);
    const Outcome outcome = outcome_of(".mcap", damaged, pings_written(6));
    EXPECT_EQ(outcome.lost, 0U) << bit;
    EXPECT_THAT(outcome.problems, Each(Not(HasSubstr("pings are lost")))) << bit;
  }
}

TEST(Damage, AFlippedBitInADatCostsItsRecord) {
  expect_at_most(1, ".dat", dat_log(5), pings_written(5));
}

TEST(Damage, AFlippedBitInAGlfCostsItsRecord) {
  expect_at_most(1, ".glf", glf_log(5), pings_written(5));
}

constexpr std::size_t magic_size = 8;  ///< the format of a log is known by its first bytes

/// @param moved number of bytes too many (positive) or missing (negative) at `at`
/// @param filler value of the bytes that are too many
Bytes with_moved_bytes(Bytes bytes, std::size_t at, int moved, std::uint8_t filler = 0xA5) {
  const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  if (moved > 0) {
    bytes.insert(place, static_cast<std::size_t>(moved), filler);
  } else {
    bytes.erase(place, place + std::min<std::ptrdiff_t>(-moved, bytes.end() - place));
  }
  return bytes;
}

/// Bytes that are too many or missing at a place, as after a copy that failed: such a place may lose at most
/// `most_lost` pings, and a loss must be reported.
void expect_at_most_when_moved(std::size_t most_lost, const std::string& suffix, const Bytes& whole,
                               const Pings& written) {
  const Outcome undamaged = outcome_of(suffix, whole, written);
  ASSERT_EQ(undamaged.lost, 0U);
  std::size_t places_that_lose = 0;
  for (const int moved : {1, 7, 512, -1, -5, -40}) {
    for (std::size_t at = magic_size; at < whole.size(); ++at) {
      const Outcome outcome = outcome_of(suffix, with_moved_bytes(whole, at, moved), written);
      ASSERT_TRUE(outcome.opened) << moved << " bytes at " << at << ": " << outcome.problems.at(0);
      ASSERT_LE(outcome.lost, most_lost)
          << moved << " bytes at " << at << ": " << testing::PrintToString(outcome.problems);
      if (outcome.pings < written.size()) {
        ASSERT_GT(outcome.problems.size(), undamaged.problems.size()) << moved << " bytes at " << at;
      }
      places_that_lose += outcome.lost > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(places_that_lose, whole.size()) << "most bytes are those of pings";
}

/// Like the above, with bytes of each value that begins a record of an MCAP file, or of none, at every place
/// of the part in the middle of the log.
void expect_at_most_with_any_byte_more(std::size_t most_lost, const Bytes& whole, const Pings& written,
                                       std::size_t from, std::size_t to) {
  const Outcome undamaged = outcome_of(".mcap", whole, written);
  ASSERT_EQ(undamaged.lost, 0U);
  for (const int filler : {0x00, 0x03, 0x05, 0x06, 0x07, 0x09, 0x0C, 0x0F, 0x55, 0xA5, 0xFF}) {
    for (std::size_t at = from; at < to; ++at) {
      const Bytes damaged = with_moved_bytes(whole, at, 1, static_cast<std::uint8_t>(filler));
      const Outcome outcome = outcome_of(".mcap", damaged, written);
      ASSERT_TRUE(outcome.opened) << filler << " at " << at;
      ASSERT_LE(outcome.lost, most_lost)
          << filler << " at " << at << ": " << testing::PrintToString(outcome.problems);
      if (outcome.lost > 0) {
        ASSERT_THAT(outcome.problems, Contains(AnyOf(HasSubstr("are lost"), HasSubstr("may be lost"))))
            << filler << " at " << at;
      }
    }
  }
}

// The length of an index of two messages, read one byte too early, is 9735: many chunks of this log.
TEST(Damage, AByteTooManyInALongMcapCostsTheChunkThere) {
  constexpr int images = 64;
  for (const bool finished : {true, false}) {
    const Bytes whole = mcap_log(images, false, finished);
    Bytes copy = whole;
    const auto place = [&](int number) {
      return static_cast<std::size_t>(place_of(samples_of(number), copy) - copy.begin());
    };
    ASSERT_GT(whole.size() - place(8), 9735U);
    expect_at_most_with_any_byte_more(2, whole, pings_written(images), place(6), place(8));
  }
}

TEST(Damage, BytesTooManyOrMissingInAGlfCostThePingsThere) {
  expect_at_most_when_moved(2, ".glf", glf_log(5), pings_written(5));
  expect_at_most_when_moved(2, ".glf", glf_log(5, 150), pings_written(5));
}

TEST(Damage, BytesTooManyOrMissingInADatCostThePingsThere) {
  expect_at_most_when_moved(2, ".dat", dat_log(5), pings_written(5));
}

TEST(Damage, BytesTooManyOrMissingInAnMcapCostTheChunksThere) {
  expect_at_most_when_moved(4, ".mcap", mcap_log(8, false, true), pings_written(8));
  expect_at_most_when_moved(4, ".mcap", mcap_log(8, true, false), pings_written(8));
}

Bytes with_zeros_at_start(Bytes bytes, std::size_t count) {
  std::fill_n(bytes.begin(), count, std::uint8_t{0});
  return bytes;
}

Bytes with_flipped_bit(Bytes bytes, std::size_t at) {
  bytes[at] ^= 4U;
  return bytes;
}

TEST(Damage, ADamagedStartOfAnMcapIsToldAndCostsNoPing) {
  constexpr std::size_t first_chunk = magic_size + 9 + 12;  // after the magic and a header that holds "test"
  for (const bool finished : {true, false}) {
    for (const bool compressed : {false, true}) {
      const Bytes whole = mcap_log(6, compressed, finished);
      // By the number of bytes that are left before the first record.
      const std::map<std::size_t, Bytes> starts{{magic_size - 3, with_moved_bytes(whole, 0, -3)},
                                                {magic_size, with_flipped_bit(whole, 2)},
                                                {magic_size + 5, with_moved_bytes(whole, 0, 5)},
                                                {first_chunk, with_zeros_at_start(whole, magic_size + 4)}};
      for (const auto& [size, bytes] : starts) {
        for (const char* const suffix : {".mcap", ".mcap.damaged", ".mcap.damaged-2"}) {
          const Outcome outcome = outcome_of(suffix, bytes, pings_written(6));
          EXPECT_EQ(outcome.lost, 0U) << size << ": " << testing::PrintToString(outcome.problems);
          EXPECT_THAT(outcome.problems,
                      Contains(fmt::format(
                          "damaged: the first {} bytes cannot be read (bad_value: field magic at byte 0); "
                          "no ping is lost",
                          size)));
        }
      }
    }
  }
}

TEST(Damage, ATextWithTheNameOfALogIsCalledNoLog) {
  const std::string text = "this is the text of somebody, and not a log at all\n";
  const Bytes bytes(text.begin(), text.end());
  EXPECT_THAT(outcome_of(".mcap", bytes, {}).problems, ElementsAre(HasSubstr("is not an .mcap log")));
  const test::TemporaryLog temporary(".pcapng", bytes);
  const LogFile file(temporary.path());
  EXPECT_THROW(summarise(file, [](auto) { return std::nullopt; }, {}), Error);
}

TEST(Damage, AGlfWithoutBlocksAfterAPlaceSaysHowManyBytesAreNotRead) {
  Bytes bytes = glf_log(5, 150);
  const Bytes entry{'P', 'K', 1, 2};  // of the directory
  ASSERT_NE(std::search(bytes.begin(), bytes.end(), entry.begin(), entry.end()), bytes.end());
  const auto from = bytes.begin() + 400;
  std::fill(from, bytes.end(), 0xA5);
  const Outcome outcome = outcome_of(".glf", bytes, pings_written(5));
  EXPECT_THAT(outcome.problems, Contains(AllOf(HasSubstr("bytes at the end of the file are not read"))));
}

TEST(Damage, InfoSaysWhereAChunkIsDamagedAndHowManyPingsAreLost) {
  Bytes bytes = mcap_log(6, false, true);
  const auto place = place_of(samples_of(2), bytes);
  ASSERT_NE(place, bytes.end());
  *place ^= 1U;
  const Outcome outcome = outcome_of(".mcap", bytes, pings_written(6));
  EXPECT_EQ(outcome.lost, 2U);
  EXPECT_THAT(outcome.problems, Contains(HasSubstr("chunk.uncompressed_crc at byte")));
  EXPECT_THAT(outcome.problems, Contains(HasSubstr("; 2 pings are lost")));
  EXPECT_THAT(outcome.problems, Not(Contains(HasSubstr("what follows"))));
}

TEST(Damage, ReplayAndInfoTellAnImageThatDoesNotUnpackWhenTheyOpenTheLog) {
  Bytes dat;
  for (int number = 0; number < 3; ++number) {
    glf::ImageRecord image = glf_image(number);
    image.pixels.assign(60, static_cast<std::uint8_t>(number));  // compresses well
    Bytes record = glf::encode(image);
    if (number == 1) {
      record[glf::ci_header_size + glf::image_header_size + 4] ^= 1U;  // a byte of the zlib stream
    }
    dat.insert(dat.end(), record.begin(), record.end());
  }
  dat.insert(dat.end(), glf::dat_terminator.begin(), glf::dat_terminator.end());
  const test::TemporaryLog temporary(".dat", dat);
  const LogFile file(temporary.path());
  const auto recording = open_log(file, {});
  ASSERT_EQ(recording->heads().at(0).pings.size(), 2U);
  EXPECT_LT(recording->heads()[0].bearings_rad.at(0), 0.0) << "the first beam is to port";
  EXPECT_EQ(recording->samples(recording->heads()[0].pings[1]), Bytes(60, 2));
  EXPECT_THAT(recording->problems(),
              ElementsAre(AllOf(HasSubstr("damaged: "), HasSubstr("; 1 ping is lost"))));
}

TEST(Damage, AWrongByteAmongRawPixelsOfAGlfShowsInItsChecksum) {
  Bytes bytes = glf_log(5);
  const auto place = place_of(samples_of(2), bytes);
  ASSERT_NE(place, bytes.end()) << "zlib makes 60 such bytes no shorter";
  *place ^= 1U;
  EXPECT_THAT(outcome_of(".glf", bytes, pings_written(5)).problems,
              Contains(HasSubstr("the checksum of the archive does not match")));
  EXPECT_THAT(outcome_of(".glf", glf_log(5), pings_written(5)).problems, IsEmpty());
}

constexpr std::size_t captured_pings = 8;
constexpr std::size_t captured_block = 80;  ///< 32 bytes around an IPv4 packet of 48

/// Datagrams of 20 bytes, each of which is a ping of head 7.
Bytes capture(std::string_view application) {
  pcapng::Writer writer(application);
  const std::uint32_t lan = writer.add_interface("lan");
  for (std::uint64_t i = 0; i < captured_pings; ++i) {
    const Bytes payload(20, static_cast<std::uint8_t>(i));
    writer.add_packet(lan, 1'000'000'000 + i, pcapng::udp_packet({0x7F000002, 1}, {0x7F000001, 2}, payload));
  }
  return writer.take();
}

LogSummary summary_of_capture(const Bytes& bytes) {
  const test::TemporaryLog temporary(".pcapng", bytes);
  return summarise(LogFile(temporary.path()),
                   [](std::span<const std::uint8_t> datagram) -> std::optional<CapturedPing> {
                     return datagram.size() == 20 ? std::optional(CapturedPing{"fan", 7, {}}) : std::nullopt;
                   },
                   {});
}

LogSummary summary_of_capture(Bytes bytes, std::size_t at, int bit) {
  bytes[at] ^= static_cast<std::uint8_t>(1U << bit);
  return summary_of_capture(bytes);
}

TEST(Damage, BytesTooManyOrMissingInACaptureCostThePacketsThere) {
  const Bytes whole = capture("sonard 0.1.0");
  for (const int moved : {1, 7, 512, -1, -5, -40}) {
    for (std::size_t at = magic_size; at < whole.size(); at += 3) {
      const LogSummary log = summary_of_capture(with_moved_bytes(whole, at, moved));
      ASSERT_FALSE(log.heads.empty()) << moved << " bytes at " << at;
      ASSERT_GE(log.heads[0].pings(), captured_pings - 2) << moved << " bytes at " << at;
      if (log.heads[0].pings() < captured_pings) {
        ASSERT_FALSE(log.problems.empty()) << moved << " bytes at " << at;
      }
    }
  }
}

TEST(Damage, AFlippedBitInACaptureCostsItsPacket) {
  const Bytes whole = capture("sonard 0.1.0");
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      const LogSummary log = summary_of_capture(whole, at, bit);
      ASSERT_FALSE(log.heads.empty()) << at;
      ASSERT_GE(log.heads[0].pings(), captured_pings - 1) << at;
      if (log.heads[0].pings() < captured_pings) {
        ASSERT_FALSE(log.problems.empty()) << "a loss is said: bit " << bit << " of byte " << at;
      }
    }
  }
}

TEST(Damage, InfoSaysWhereABlockTypeOfACaptureIsDamaged) {
  for (const std::string_view application : {"sonard 0.1.0", "another program"}) {
    const Bytes whole = capture(application);
    const std::size_t at = whole.size() - 3 * captured_block;
    for (int bit = 0; bit < 32; ++bit) {
      const LogSummary log = summary_of_capture(whole, at + static_cast<std::size_t>(bit) / 8, bit % 8);
      EXPECT_EQ(log.heads.at(0).pings(), captured_pings - 1);
      EXPECT_THAT(log.problems, Contains(AllOf(HasSubstr(fmt::format("80 bytes at byte {} ", at)),
                                               HasSubstr("block_type"))))
          << application << ": bit " << bit;
    }
  }
}

TEST(Damage, InfoTellsAPacketOfAnInterfaceThatIsNotThere) {
  const Bytes whole = capture("another program");
  const LogSummary log = summary_of_capture(whole, whole.size() - 3 * captured_block + 8, 1);
  EXPECT_EQ(log.heads.at(0).pings(), captured_pings);
  EXPECT_THAT(log.problems, Contains(HasSubstr("1 packet names an interface")));
}

TEST(Damage, ADamagedStartOfACaptureIsToldAndCostsNoPacket) {
  const Bytes whole = capture("sonard 0.1.0");
  constexpr std::size_t section = 12 + 16 + 16 + 4;  // with an option of 12 bytes, and the end of options
  const std::map<std::size_t, Bytes> starts{{5, with_moved_bytes(whole, 0, 5)},
                                            {section - 3, with_moved_bytes(whole, 0, -3)},
                                            {section, with_zeros_at_start(whole, section)}};
  for (const auto& [size, bytes] : starts) {
    const LogSummary log = summary_of_capture(bytes);
    ASSERT_EQ(log.heads.size(), 1U) << size;
    EXPECT_EQ(log.heads[0].pings(), captured_pings) << size;
    EXPECT_THAT(log.problems,
                Contains(AllOf(HasSubstr(fmt::format("damaged: the first {} bytes cannot be read", size)),
                               HasSubstr("no packet is lost"))));
  }
}

TEST(Damage, InfoTellsADamagedByteOrderMagicOfACapture) {
  EXPECT_THAT(summary_of_capture(capture("sonard 0.1.0"), 8, 3).problems,
              Contains(HasSubstr("byte_order_magic")));
}

}  // namespace
}  // namespace sonard::server
