// SPDX-License-Identifier: Apache-2.0
#include "server/info/thumbnails.hpp"

#include <algorithm>
#include <fstream>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "common/text/printable.hpp"
#include "protocol/common/linear_samples.hpp"
#include "renderer/picture/fan_image.hpp"
#include "renderer/picture/picture_file.hpp"
#include "server/info/recorded_sweeps.hpp"

namespace sonard::server {
namespace {

constexpr picture::FanStyle thumbnail_style{.radius_px = 300, .grid = true};

bool drawable(const picture::FanShape& shape, const RecordedSettings& settings) {
  constexpr double quarter_turn_rad = 1.5707963267948966;
  const auto& bearings = shape.bearings_rad;
  return bearings.size() == static_cast<std::size_t>(settings.beams) && bearings.size() >= 2 &&
         std::ranges::adjacent_find(bearings, std::ranges::greater_equal{}) == bearings.end() &&
         bearings.front() > -quarter_turn_rad && bearings.back() < quarter_turn_rad;
}

// Names come from the log and must not lead out of the folder.
std::string file_name(const LoggedHead& head, std::uint64_t number) {
  std::string name = head.name.empty() ? fmt::format("{}", head.device_id) : printable(head.name);
  std::ranges::replace_if(
      name, [](char c) { return c == '/'; }, '_');
  return fmt::format("{}_{:06}.png", name, number);
}

void write_picture(const std::filesystem::path& path, const cv::Mat& picture) {
  const std::string png = picture::png_file(picture, 1);
  if (!std::ofstream(path, std::ios::binary)
           .write(png.data(), static_cast<std::streamsize>(png.size()))
           .flush()) {
    throw Error(ErrorKind::configuration, fmt::format("{}: cannot be written", path.string()));
  }
}

std::uint64_t write_fans(const LogReader& reader, const LoggedHead& head, const LogFile& file,
                         const std::filesystem::path& folder, std::uint64_t every) {
  std::optional<picture::FanImage> fan;
  std::uint64_t written = 0;
  for (std::uint64_t ping = 0; ping < head.pings.size(); ping += every, ++written) {
    const LoggedPing& image = head.pings[ping];
    const picture::FanShape shape{head.bearings_rad, image.settings.bins, image.settings.bin_m};
    if (!drawable(shape, image.settings)) {
      throw file.error(
          fmt::format("ping {} of sonar {} has beams that do not form a fan", ping, head.device_id));
    }
    if (!fan || fan->geometry().shape() != shape) {
      fan.emplace(shape, thumbnail_style);
    }
    std::vector<std::uint8_t> pixels = reader.samples(image);
    make_linear(pixels, image.settings.amplitude_exponent);
    const cv::Mat polar(image.settings.bins, image.settings.beams, CV_8UC1, pixels.data());
    write_picture(folder / file_name(head, ping),
                  fan->draw(polar, fmt::format("{} ping {}", head.device_id, ping)));
  }
  return written;
}

picture::SweepLine drawn_line(const LogReader& reader, const LoggedPing& line) {
  picture::SweepLine drawn{picture_bearing(line), reader.samples(line)};
  if (line.bits_per_bin == 4) {
    constexpr int to_full_scale = 17;
    std::ranges::transform(drawn.samples, drawn.samples.begin(), [](std::uint8_t bin) {
      return static_cast<std::uint8_t>(std::min(bin * to_full_scale, 255));
    });
  }
  return drawn;
}

std::uint64_t write_sweeps(const LogReader& reader, const LoggedHead& scan,
                           const std::filesystem::path& folder, std::uint64_t every) {
  const std::vector<RecordedSweep> sweeps = sweeps_of(scan);
  std::uint64_t written = 0;
  for (std::uint64_t number = 0; number < sweeps.size(); number += every, ++written) {
    const RecordedSweep& sweep = sweeps[number];
    std::vector<picture::SweepLine> lines;
    for (std::size_t place = sweep.begin; place < sweep.end; ++place) {
      lines.push_back(drawn_line(reader, scan.pings[place]));
    }
    const picture::SweepImage image(sweep.shape, thumbnail_style);
    write_picture(
        folder / file_name(scan, number),
        image.draw(lines, fmt::format("{} turn {}, {} lines", scan.device_id, number, lines.size())));
  }
  return written;
}

}  // namespace

std::uint64_t write_thumbnails(const LogReader& reader, const LogFile& file,
                               const std::filesystem::path& folder, std::uint64_t every) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw Error(ErrorKind::configuration,
                fmt::format("{}: cannot be created: {}", folder.string(), error.message()));
  }
  std::uint64_t written = 0;
  for (const LoggedHead& head : reader.heads()) {
    written += head.scanning ? write_sweeps(reader, head, folder, every)
                             : write_fans(reader, head, file, folder, every);
  }
  return written;
}

}  // namespace sonard::server
