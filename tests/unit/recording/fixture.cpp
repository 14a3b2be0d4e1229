// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/recording/fixture.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace sonard::test {

namespace fs = std::filesystem;
using server::RecordingEvent;
using server::TimePoint;

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "sonard-recording-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("no temporary folder");
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryFolder::names(const std::string& suffix) const {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_)) {
    if (const std::string name = entry.path().filename().string(); name.ends_with(suffix)) {
      names.push_back(name);
    }
  }
  std::ranges::sort(names);
  return names;
}

FileSizeLimit::FileSizeLimit(std::uint64_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);
  getrlimit(RLIMIT_FSIZE, &before_);
  const rlimit limit{bytes, before_.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
}

FileSizeLimit::~FileSizeLimit() {
  setrlimit(RLIMIT_FSIZE, &before_);
}

std::vector<std::uint8_t> contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_file(const fs::path& path, const std::vector<std::uint8_t>& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

std::uint8_t sample(std::uint64_t ping_number, int line, int beam) {
  std::uint64_t x =
      ping_number * 1'000'003 + static_cast<std::uint64_t>(line) * 257 + static_cast<std::uint64_t>(beam) + 1;
  x *= 0x9E3779B97F4A7C15;  // as in splitmix64
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EB;
  return static_cast<std::uint8_t>((x ^ (x >> 31)) & 0xFF);
}

gemini::EncodedPing encoded_ping(std::uint64_t number, int lines, std::uint16_t ext_mode,
                                 std::uint8_t rle_threshold) {
  gemini::PingHead head;
  head.header.sonar_id = 601;
  head.ping_id = static_cast<std::uint16_t>(number & 0xFF);
  head.ext_mode = ext_mode;
  head.end_range = static_cast<std::uint16_t>(lines);
  head.sound_speed_used = 0x8000 | 15'000;
  head.rle_threshold = rle_threshold;
  gemini::PingImage image{number, {}, {}};
  for (int line = 0; line < lines; ++line) {
    for (int beam = 0; beam < gemini::beam_count; ++beam) {
      if (head.eight_bit()) {
        image.u8.push_back(sample(number, line, beam));
      } else {
        image.u16.push_back(static_cast<std::uint16_t>(sample(number, line, beam) << 8 | 0x5A));
      }
    }
  }
  return {head, 0, image};
}

RecordingEvent ping_event(std::uint64_t number, int lines, TimePoint time) {
  const auto poses = std::make_shared<const server::PosesUsed>(server::PosesUsed{time, {}, {}, {}});
  return {0, time, server::GeminiPingServed{{number, encoded_ping(number, lines)}, time, 50.0, poses}};
}

RecordingEvent wire_event(std::size_t bytes, TimePoint time) {
  const gemini::SharedBytes data(std::vector<std::uint8_t>(bytes, 0x42));
  return {0, time,
          server::WirePassed{
              true, server::WireTransport::udp, {}, {{{0x7F000001, 52900}, {0x7F000002, 52901}, data}}}};
}

std::vector<server::HeadToRecord> one_gemini() {
  return {{"bow", 601, true, 0}};
}

}  // namespace sonard::test
