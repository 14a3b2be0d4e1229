// SPDX-License-Identifier: Apache-2.0
// glf_tool write DIR    writes the test log to DIR: log.glf, log.dat, log.json (expected values), log.pixels
// glf_tool read FILE    prints as JSON the values that the library reads from a log
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocol/glf/codec.hpp"
#include "protocol/glf/deflate.hpp"
#include "protocol/glf/headers.hpp"
#include "protocol/glf/log_config.hpp"
#include "protocol/glf/log_time.hpp"
#include "protocol/glf/log_view.hpp"
#include "protocol/glf/packer.hpp"

namespace {

using namespace sonard::glf;

constexpr double start_s = 1'479'651'753.25;
constexpr int images = 20;
constexpr int images_per_status = 5;

std::uint32_t crc_of(std::span<const std::uint8_t> bytes) {
  Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

ImageRecord image(int number) {
  const bool second = number % 2 == 1;
  const double time_s = start_s + 0.125 * number;
  ImageRecord image{.origin = {.time_s = time_s, .device_id = 1194, .node_id = 100},
                    .lines = 500,
                    .beams = 256,
                    .pixels = {},
                    .bearings_rad = {},
                    .modulation_frequency_hz = 18'750,
                    .transmit_time_s = time_s,
                    .ping_flags = ping_flag_bits::manual_sound_speed,
                    .sound_speed_mps = 1500.0F,
                    .gain_percent = static_cast<std::int16_t>(40 + number),
                    .platform = Platform::gemini_720is};
  if (second) {
    image.origin.device_id = 2001;
    image.origin.node_id = 101;
    image.lines = 700;
    image.beams = 512;
    image.state_flags = 0x80000001;
    image.modulation_frequency_hz = 14'805;
    image.aperture_deg = 65.5F;
    image.ping_flags = ping_flag_bits::high_frequency;
    image.sound_speed_mps = 1480.5F;
    image.chirp = true;
    image.sonar_type = SonarType::mk2_imager;
    image.platform = Platform::gemini_1200ik;
  }
  std::mt19937 random{static_cast<unsigned>(number)};
  const bool noise = number == 6 || number == 7;  // one image of each sonar
  for (unsigned line = 0; line < image.lines; ++line) {
    for (unsigned beam = 0; beam < image.beams; ++beam) {
      const unsigned pattern = 7U * static_cast<unsigned>(number) + 3U * line + 5U * beam;
      image.pixels.push_back(static_cast<std::uint8_t>(noise ? random() : pattern));
    }
  }
  for (unsigned beam = 0; beam < image.beams; ++beam) {
    const double wire_rad = (2.0 * beam + 1.0 - image.beams) / image.beams * (second ? 0.57 : 1.0405);
    image.bearings_rad.push_back(bearing_for_log(wire_rad));
  }
  return image;
}

StatusRecord status(int number) {
  return {.origin = {.time_s = start_s + 0.125 * number + 0.0625, .device_id = 1194, .node_id = 100},
          .bf_firmware_version = 3,
          .device_id = 1194,
          .transducer_c = 11.25 + number,
          .packet_count = 70'000U + static_cast<std::uint32_t>(number),
          .fpga_time_us = 5'000'000'000U,
          .shutdown_status = 4};
}

std::string json(const ImageRecord& r, std::uint32_t pixels_crc) {
  return fmt::format(
      R"({{"type": 0, "time_s": {}, "device_id": {}, "node_id": {}, "lines": {}, "beams": {}, "state_flags": {}, )"
      R"("modulation_frequency_hz": {}, "aperture_deg": {}, "transmit_time_s": {}, "ping_flags": {}, )"
      R"("sound_speed_mps": {}, "gain_percent": {}, "chirp": {}, "sonar_type": {}, "platform": {}, )"
      R"("pixels_crc": {}, "bearings_rad": [{}]}})",
      r.origin.time_s, r.origin.device_id, r.origin.node_id, r.lines, r.beams, r.state_flags,
      r.modulation_frequency_hz, r.aperture_deg, r.transmit_time_s, r.ping_flags, r.sound_speed_mps,
      r.gain_percent, r.chirp, static_cast<int>(r.sonar_type), static_cast<int>(r.platform), pixels_crc,
      fmt::join(r.bearings_rad, ", "));
}

std::string json(const StatusRecord& r) {
  return fmt::format(
      R"({{"type": 3, "time_s": {}, "device_id": {}, "node_id": {}, "bf_firmware_version": {}, )"
      R"("transducer_c": {}, "packet_count": {}, "fpga_time_us": {}, "shutdown_status": {}}})",
      r.origin.time_s, r.device_id, r.origin.node_id, r.bf_firmware_version, r.transducer_c, r.packet_count,
      r.fpga_time_us, r.shutdown_status);
}

class File {
 public:
  explicit File(const std::filesystem::path& path) : stream_(path, std::ios::binary) {
    stream_.exceptions(std::ios::failbit | std::ios::badbit);
  }
  void write(std::span<const std::uint8_t> bytes) {
    stream_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  void write(const std::string& text) { stream_ << text; }

 private:
  std::ofstream stream_;
};

void pack(const std::filesystem::path& path, std::span<const std::uint8_t> dat) {
  const double end_s = start_s + 2.5;
  const Packer packer{log_stamp(start_s),
                      config_xml({.app_name = "glf_tool",
                                  .creation_time_s = start_s,
                                  .close_time_s = end_s,
                                  .device_ids = {1194, 2001}}),
                      {.size = dat.size(), .crc = crc_of(dat)},
                      civil_time(end_s)};
  File file{path};
  file.write(packer.head());
  for (std::size_t begin = 0; begin < dat.size(); begin += pack_block_size) {
    const auto block = dat.subspan(begin, std::min(pack_block_size, dat.size() - begin));
    file.write(Packer::block_header(block.size()));
    file.write(block);
  }
  file.write(packer.tail());
}

void write_log(const std::filesystem::path& folder) {
  Bytes dat;
  Bytes pixels;
  std::vector<std::string> records;
  const auto append = [](Bytes& all, const Bytes& part) { all.insert(all.end(), part.begin(), part.end()); };
  for (int number = 0; number < images; ++number) {
    const ImageRecord record = image(number);
    append(dat, encode(record));
    append(pixels, record.pixels);
    records.push_back(json(record, crc_of(record.pixels)));
    if (number % images_per_status == 0) {
      append(dat, encode(status(number)));
      records.push_back(json(status(number)));
    }
  }
  dat.insert(dat.end(), dat_terminator.begin(), dat_terminator.end());
  File{folder / "log.dat"}.write(dat);
  File{folder / "log.pixels"}.write(pixels);
  File{folder / "log.json"}.write(fmt::format("[{}]\n", fmt::join(records, ",\n")));
  pack(folder / "log.glf", dat);
}

int read_log(const std::filesystem::path& path) {
  std::ifstream stream{path, std::ios::binary};
  const Bytes file{std::istreambuf_iterator<char>{stream}, {}};
  const auto log = LogView::open(file);
  if (!log) {
    fmt::print(stderr, "{}: {}\n", path.string(), to_string(log.error()));
    return 1;
  }
  std::vector<std::string> records;
  for (const RecordEntry& entry : log->index().records) {
    if (entry.type == RecordType::image) {
      const ImageRecord record = log->image(entry).value();
      records.push_back(json(record, crc_of(record.pixels)));
    } else {
      records.push_back(json(log->status(entry).value()));
    }
  }
  fmt::print(R"({{"closed": {}, "records": [{}]}})", log->index().closed, fmt::join(records, ",\n"));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 2 && arguments[0] == "write") {
    write_log(arguments[1]);
    return 0;
  }
  if (arguments.size() == 2 && arguments[0] == "read") {
    return read_log(arguments[1]);
  }
  fmt::print(stderr, "usage: glf_tool write DIR | read FILE\n");
  return 64;
}
