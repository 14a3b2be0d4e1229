// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/compare/glf_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "protocol/glf/log_view.hpp"

namespace sonard::client {

cv::Mat read_glf_image(const std::filesystem::path& file, std::uint64_t number) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const auto refuse = [&](const std::string& why) {
    return std::runtime_error(fmt::format("{}: {}", file.string(), why));
  };
  const auto log = glf::LogView::open(bytes);
  if (!log) {
    throw refuse(fmt::format("is not a log: {}", to_string(log.error())));
  }
  std::uint64_t images = 0;
  for (const auto& entry : log->index().records) {
    if (entry.type != glf::RecordType::image || images++ != number) {
      continue;
    }
    const auto image = log->image(entry);
    if (!image) {
      throw refuse(fmt::format("image {}: {}", number, to_string(image.error())));
    }
    cv::Mat polar(static_cast<int>(image->lines), static_cast<int>(image->beams), CV_8UC1);
    std::copy(image->pixels.begin(), image->pixels.end(), polar.begin<std::uint8_t>());
    return polar;
  }
  throw refuse(fmt::format("has no image {}; it has {} images", number, images));
}

}  // namespace sonard::client
