// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/server/recording/fixture.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>

namespace sonard::test {

namespace fs = std::filesystem;
using server::RecordingEvent;
using server::TimePoint;

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

PingRecord ping_record(std::uint64_t number, int lines, TimePoint time) {
  constexpr int beams = 256;
  PingRecord ping;
  ping.number = number;
  ping.transmit_time = time;
  ping.settings = {.bins = lines,
                   .beams = beams,
                   .bin_m = 1500.0 / 2.0 / 90'422.0,
                   .sound_speed_mps = 1500.0,
                   .gain_percent = 50.0,
                   .frequency_hz = 720'000.0};
  for (int beam = 0; beam < beams; ++beam) {
    ping.bearings_rad.push_back((beam - 127.5) / 128.0);
  }
  ping.sector_rad = 2.0;
  for (int line = 0; line < lines; ++line) {
    for (int beam = 0; beam < beams; ++beam) {
      ping.samples.push_back(sample(number, line, beam));
    }
  }
  return ping;
}

RecordingEvent ping_event(std::uint64_t number, int lines, TimePoint time) {
  const auto poses = std::make_shared<const server::PosesUsed>(server::PosesUsed{time, {}, {}, {}});
  return {0, time, server::PingSent{ping_record(number, lines, time), poses}};
}

RecordingEvent wire_event(std::size_t bytes, TimePoint time) {
  const SharedBytes data(std::vector<std::uint8_t>(bytes, 0x42));
  return {0, time,
          server::WirePassed{
              true, server::WireTransport::udp, {}, {{{0x7F000001, 52900}, {0x7F000002, 52901}, data}}}};
}

const server::GlfDevice& glf_device_without_statuses() {
  static const struct : server::GlfDevice {
    std::optional<glf::StatusRecord> glf_status(std::span<const std::uint8_t>) const override {
      return std::nullopt;
    }
  } device;
  return device;
}

std::vector<server::HeadToRecord> one_head() {
  return {{"bow", "gemini_720i", 601, &glf_device_without_statuses()}};
}

}  // namespace sonard::test
