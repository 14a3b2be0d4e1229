// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/png_file.hpp"

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "renderer/picture/amber.hpp"

namespace sonard::pictures {
namespace {

namespace amber = picture::amber;

using Bytes = std::vector<std::uint8_t>;

/// 43 colours of echoes, and three ramps of 64: background to grid, background to labels, grid to labels.
std::vector<cv::Vec3b> palette_of_pictures() {
  std::vector<cv::Vec3b> colours;
  const cv::Mat echoes = amber::palette(amber::Samples::decibels);
  for (int value = 2; value < 256; value += 6) {
    colours.push_back(echoes.at<cv::Vec3b>(0, value));
  }
  const auto add_ramp = [&](const cv::Scalar& from, const cv::Scalar& to) {
    constexpr int steps = 64;
    for (int i = 0; i < steps; ++i) {
      const cv::Scalar mixed = from + (to - from) * (static_cast<double>(i) / (steps - 1));
      colours.emplace_back(cv::saturate_cast<uchar>(mixed[0]), cv::saturate_cast<uchar>(mixed[1]),
                           cv::saturate_cast<uchar>(mixed[2]));
    }
  };
  add_ramp(amber::background(), amber::grid());
  add_ramp(amber::background(), amber::label());
  add_ramp(amber::grid(), amber::label());
  return colours;
}

/// Index of the nearest palette colour. Each colour is searched for once.
class Indices {
 public:
  explicit Indices(std::vector<cv::Vec3b> colours) : colours_(std::move(colours)) {}

  std::uint8_t of(const cv::Vec3b& colour) {
    const int key = colour[0] << 16 | colour[1] << 8 | colour[2];
    const auto known = known_.find(key);
    return known != known_.end() ? known->second : known_.emplace(key, nearest(colour)).first->second;
  }

 private:
  std::uint8_t nearest(const cv::Vec3b& colour) const {
    std::size_t best = 0;
    double best_distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < colours_.size(); ++i) {
      const double distance = cv::norm(colours_[i], colour, cv::NORM_L2SQR);
      if (distance < best_distance) {
        best = i;
        best_distance = distance;
      }
    }
    return static_cast<std::uint8_t>(best);
  }

  std::vector<cv::Vec3b> colours_;
  std::unordered_map<int, std::uint8_t> known_;
};

void append_u32(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

/// Length, type, data, CRC of type and data (ISO 15948, 5.3).
void append_chunk(Bytes& png, const std::string& type, const Bytes& data) {
  append_u32(png, static_cast<std::uint32_t>(data.size()));
  const std::size_t start = png.size();
  png.insert(png.end(), type.begin(), type.end());
  png.insert(png.end(), data.begin(), data.end());
  append_u32(png,
             static_cast<std::uint32_t>(crc32(0, png.data() + start, static_cast<uInt>(png.size() - start))));
}

Bytes compressed(const Bytes& raw) {
  uLongf size = compressBound(raw.size());
  Bytes packed(size);
  if (compress2(packed.data(), &size, raw.data(), raw.size(), Z_BEST_COMPRESSION) != Z_OK) {
    throw std::runtime_error("a picture cannot be compressed");
  }
  packed.resize(size);
  return packed;
}

Bytes encoded(const cv::Mat& picture) {
  const std::vector<cv::Vec3b> colours = palette_of_pictures();
  Bytes header;
  append_u32(header, static_cast<std::uint32_t>(picture.cols));
  append_u32(header, static_cast<std::uint32_t>(picture.rows));
  header.insert(header.end(), {8, 3, 0, 0, 0});  // 8 bits, palette, no interlace
  Bytes palette;
  for (const cv::Vec3b& bgr : colours) {
    palette.insert(palette.end(), {bgr[2], bgr[1], bgr[0]});
  }
  Bytes rows;
  Indices indices(colours);
  for (int y = 0; y < picture.rows; ++y) {
    rows.push_back(0);  // this row without a filter
    for (int x = 0; x < picture.cols; ++x) {
      rows.push_back(indices.of(picture.at<cv::Vec3b>(y, x)));
    }
  }
  Bytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  append_chunk(png, "IHDR", header);
  append_chunk(png, "PLTE", palette);
  append_chunk(png, "IDAT", compressed(rows));
  append_chunk(png, "IEND", {});
  return png;
}

}  // namespace

void write_png(const std::filesystem::path& file, const cv::Mat& picture) {
  const Bytes png = encoded(picture);
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  if (!out.flush()) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace sonard::pictures
