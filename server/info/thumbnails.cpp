#include "server/info/thumbnails.hpp"

#include <algorithm>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "renderer/picture/fan_image.hpp"

namespace sonard::server {
namespace {

constexpr picture::FanLook thumbnail_look{.radius_px = 300, .grid = true};

// Bearings of the recording are positive to port, those of pictures to starboard.
picture::FanShape shape_of(const RecordedHead& head, const RecordedSettings& settings) {
  picture::FanShape shape;
  for (const double bearing_rad : head.bearings_rad) {
    shape.bearings_rad.push_back(-bearing_rad);
  }
  shape.lines = settings.lines;
  shape.line_step_m = settings.line_step_m;
  return shape;
}

bool drawable(const picture::FanShape& shape, const RecordedSettings& settings) {
  constexpr double quarter_turn_rad = 1.5707963267948966;
  const auto& bearings = shape.bearings_rad;
  return bearings.size() == static_cast<std::size_t>(settings.beams) && bearings.size() >= 2 &&
         std::ranges::adjacent_find(bearings, std::ranges::greater_equal{}) == bearings.end() &&
         bearings.front() > -quarter_turn_rad && bearings.back() < quarter_turn_rad;
}

// Names come from the log: they are no way out of the folder.
std::string file_name(const RecordedHead& head, std::uint64_t ping) {
  std::string name = head.name.empty() ? fmt::format("{}", head.device_id) : head.name;
  std::ranges::replace_if(
      name, [](char c) { return c == '/' || c == '\0'; }, '_');
  return fmt::format("{}_{:06}.png", name, ping);
}

}  // namespace

std::uint64_t write_thumbnails(const Recording& recording, const LogFile& file,
                               const std::filesystem::path& folder, std::uint64_t every) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw LogError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  }
  std::uint64_t written = 0;
  for (const RecordedHead& head : recording.heads()) {
    std::optional<picture::FanImage> fan;
    for (std::uint64_t ping = 0; ping < head.images.size(); ping += every) {
      const RecordedImage& image = head.images[ping];
      const picture::FanShape shape = shape_of(head, image.settings);
      if (!drawable(shape, image.settings)) {
        throw file.error(fmt::format("ping {} of sonar {} has beams that make no fan", ping, head.device_id));
      }
      if (!fan || fan->geometry().shape() != shape) {
        fan.emplace(shape, thumbnail_look);
      }
      std::vector<std::uint8_t> pixels = recording.pixels(image);
      const cv::Mat polar(image.settings.lines, image.settings.beams, CV_8UC1, pixels.data());
      const std::filesystem::path path = folder / file_name(head, ping);
      const std::string caption = fmt::format("{} ping {}", head.device_id, ping);
      if (!cv::imwrite(path.string(), fan->draw(polar, caption))) {
        throw LogError(fmt::format("{}: cannot be written", path.string()));
      }
      ++written;
    }
  }
  return written;
}

}  // namespace sonard::server
