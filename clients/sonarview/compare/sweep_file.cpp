// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/compare/sweep_file.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "renderer/picture/sweep_image.hpp"

namespace sonard::client {
namespace {

constexpr int four_bit_scale = 17;

struct ScanLine {
  std::uint64_t sweep = 0;
  picture::SweepShape shape;
  picture::SweepLine line;
};

std::vector<std::uint8_t> bytes_of(std::string_view digits, int scale) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    int value = 0;
    const char* end = digits.data() + std::min(i + 2, digits.size());
    const auto [rest, error] = std::from_chars(digits.data() + i, end, value, 16);
    if (error != std::errc() || rest != end || digits.size() - i < 2 || value * scale > 255) {
      throw std::runtime_error("bins are not two hexadecimal digits each");
    }
    bytes.push_back(static_cast<std::uint8_t>(value * scale));
  }
  return bytes;
}

int integer(const YAML::Node& object, const char* key, int least, int most) {
  const int value = object[key].as<int>();
  if (value < least || value > most) {
    throw std::runtime_error(fmt::format("{} {} is out of range", key, value));
  }
  return value;
}

/// Parses an object of docs/sonarview.md, "Lines in a file". The parser reads YAML, which includes JSON.
ScanLine parse_line(const std::string& text) {
  const YAML::Node object = YAML::Load(text);
  const int last_bearing = picture::units_per_turn - 1;
  ScanLine scan;
  scan.sweep = object["turn"].as<std::uint64_t>();
  scan.line.bearing = integer(object, "bearing", 0, last_bearing);
  scan.line.samples =
      bytes_of(object["bins"].as<std::string>(), integer(object, "bits", 4, 8) == 8 ? 1 : four_bit_scale);
  scan.shape.step = integer(object, "step", 1, 255);
  scan.shape.bins = static_cast<int>(scan.line.samples.size());
  if (!object["all_round"].as<bool>()) {
    scan.shape.left = integer(object, "left_limit", 0, last_bearing);
    const int width = integer(object, "right_limit", 0, last_bearing) - scan.shape.left;
    scan.shape.width = width < 0 ? width + picture::units_per_turn : width;
  }
  if (scan.shape.bins == 0 || scan.shape.width == 0) {
    throw std::runtime_error("the line is empty");
  }
  return scan;
}

bool same(const picture::SweepShape& a, const picture::SweepShape& b) {
  return a.left == b.left && a.width == b.width && a.step == b.step && a.bins == b.bins;
}

}  // namespace

cv::Mat read_sweep(const std::filesystem::path& file, std::uint64_t sweep) {
  std::ifstream in(file);
  std::optional<picture::SweepShape> shape;
  std::vector<picture::SweepLine> lines;
  int row = 0;
  for (std::string text; std::getline(in, text);) {
    ++row;
    const auto refuse = [&](const std::string& why) {
      throw std::runtime_error(fmt::format("{}:{}: {}", file.string(), row, why));
    };
    ScanLine scan;
    try {
      scan = parse_line(text);
    } catch (const YAML::Exception&) {
      refuse("is not a line of a scanning head (expected a line written by sonarview --raw)");
    } catch (const std::runtime_error& error) {
      refuse(error.what());
    }
    if (scan.sweep != sweep) {
      continue;
    }
    if (shape && !same(*shape, scan.shape)) {
      refuse("differs from the turn's first line in step, sector or number of bins");
    }
    shape = scan.shape;
    lines.push_back(std::move(scan.line));
  }
  if (!shape) {
    throw std::runtime_error(fmt::format("{}: has no turn {}", file.string(), sweep));
  }
  return picture::sweep_polar_image(*shape, lines);
}

}  // namespace sonard::client
