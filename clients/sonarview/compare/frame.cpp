// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/compare/frame.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <system_error>

#include "clients/sonarview/compare/glf_image.hpp"
#include "clients/sonarview/compare/sweep_file.hpp"
#include "protocol/npy/npy_file.hpp"
#include "renderer/picture/fan_image.hpp"
#include "renderer/picture/picture_file.hpp"

namespace sonard::client {
namespace {

constexpr double full_scale = 255;

/// FILE and N of "FILE#N"; without "#N" the file is the whole word.
struct Source {
  std::filesystem::path file;
  std::string number;
};

bool is_log(const std::filesystem::path& file) {
  return file.extension() == ".glf" || file.extension() == ".dat";
}

Source split(const std::string& word) {
  const std::size_t mark = word.rfind('#');
  if (mark != std::string::npos) {
    const std::filesystem::path file = word.substr(0, mark);
    if (file.extension() == ".csv" || file.extension() == ".jsonl" || is_log(file)) {
      return {file, word.substr(mark + 1)};
    }
  }
  return {word, ""};
}

std::uint64_t number_of(const Source& source, const char* what) {
  std::uint64_t number = 0;
  const char* end = source.number.data() + source.number.size();
  const auto [rest, error] = std::from_chars(source.number.data(), end, number);
  if (source.number.empty() || error != std::errc() || rest != end) {
    throw std::runtime_error(
        fmt::format("{}: expected {}#{}", source.file.string(), source.file.string(), what));
  }
  return number;
}

void check_file(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw std::runtime_error(fmt::format("{}: is a folder", file.string()));
  }
  if (!std::filesystem::exists(file, error)) {
    throw std::runtime_error(fmt::format("{}: no such file", file.string()));
  }
  if (!std::ifstream(file)) {
    const std::error_code why(errno, std::generic_category());
    throw std::runtime_error(fmt::format("{}: cannot be opened: {}", file.string(), why.message()));
  }
}

cv::Mat scaled(const cv::Mat& samples) {
  cv::Mat frame;
  samples.convertTo(frame, CV_64F, samples.depth() == CV_16U ? full_scale / 65'535 : 1.0);
  return frame;
}

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

cv::Mat read_picture(const std::filesystem::path& file) {
  cv::Mat picture;
  try {
    picture = picture::from_picture_file(contents(file));
  } catch (const cv::Exception&) {
    picture.release();  // no memory
  }
  if (picture.empty()) {
    throw std::runtime_error(fmt::format("{}: is not a PNG or JPEG picture", file.string()));
  }
  cv::cvtColor(picture, picture, cv::COLOR_BGR2GRAY);
  return picture;
}

/// <head>-<number, 8 digits>.npy beside <head>.csv, if the index lists it.
std::filesystem::path file_of_ping(const std::filesystem::path& index, std::uint64_t number) {
  std::ifstream rows(index);
  const std::string wanted = fmt::format("{},", number);
  for (std::string row; std::getline(rows, row);) {
    if (row.rfind(wanted, 0) == 0) {
      return index.parent_path() / fmt::format("{}-{:08d}.npy", index.stem().string(), number);
    }
  }
  throw std::runtime_error(fmt::format("{}: has no ping {}", index.string(), number));
}

cv::Mat read_ping(const std::filesystem::path& file) {
  check_file(file);
  std::ifstream in(file, std::ios::binary);
  auto samples = npy::parse(std::string(std::istreambuf_iterator<char>(in), {}));
  if (!samples) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(), samples.error()));
  }
  return picture::raw_polar_image(
      samples->u16.empty() ? cv::Mat(samples->rows, samples->columns, CV_8UC1, samples->u8.data())
                           : cv::Mat(samples->rows, samples->columns, CV_16UC1, samples->u16.data()));
}

}  // namespace

cv::Mat load_frame(const std::string& word) {
  const Source source = split(word);
  check_file(source.file);
  if (source.file.extension() == ".csv") {
    return scaled(read_ping(file_of_ping(source.file, number_of(source, "PING"))));
  }
  if (source.file.extension() == ".jsonl") {
    return scaled(read_sweep(source.file, number_of(source, "TURN")));
  }
  if (is_log(source.file)) {
    return scaled(picture::raw_polar_image(read_glf_image(source.file, number_of(source, "IMAGE"))));
  }
  if (source.file.extension() == ".npy") {
    return scaled(read_ping(source.file));
  }
  return scaled(read_picture(source.file));
}

}  // namespace sonard::client
