// SPDX-License-Identifier: Apache-2.0
// Pictures of the pings of a multibeam head.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/common/run_options.hpp"
#include "renderer/picture/fan_image.hpp"

namespace sonard::client {

struct FanPing {
  picture::FanShape shape;
  cv::Mat samples;  ///< as received, CV_8UC1 or CV_16UC1: a row per line, near lines first, a column per beam
  double amplitude_exponent = 1.0;  ///< samples are proportional to the amplitude to this power
  std::string caption;
};

/// Queues pictures of pings: fan-<name>.png with samples proportional to the amplitude, and polar-<name>.png
/// with samples as received.
class FanPictures {
 public:
  explicit FanPictures(const RunOptions& options)
      : style_{.radius_px = options.radius_px}, every_(options.every) {}

  /// Queues the picture of each RunOptions::every-th ping by `number`, and keeps the ping for refresh().
  void take(ImageWriter& writer, FanPing ping, std::uint64_t number);
  /// Draws the last ping, unless that was done.
  void refresh(ImageWriter& writer);
  /// At the end of the program: writes the last ping.
  void finish(ImageWriter& writer) const;

 private:
  std::vector<Picture> last_as(const std::string& name) const;

  picture::FanStyle style_;
  std::uint64_t every_;
  std::optional<FanPing> last_;
  bool last_is_shown_ = true;
  /// For the shape of the last drawn ping, because pings mostly have the same. Used on the writer's thread.
  std::shared_ptr<std::optional<picture::FanImage>> image_ =
      std::make_shared<std::optional<picture::FanImage>>();
};

}  // namespace sonard::client
