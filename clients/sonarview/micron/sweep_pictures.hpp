// SPDX-License-Identifier: Apache-2.0
// The pictures of a turn.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/micron/scan_sweeps.hpp"
#include "protocol/micron/scan_settings.hpp"
#include "renderer/picture/sweep_image.hpp"

namespace sonard::client {

/// Makes them for one ImageWriter, on whose thread they are drawn.
class SweepPictures {
 public:
  SweepPictures(const micron::ScanSettings& settings, const picture::FanStyle& style);

  /// The files turn-<name>.png, or fan-<name>.png of a sector, and polar-<name>.png; for each name.
  std::vector<Picture> of(const Sweep& sweep, const std::vector<std::string>& names) const;

 private:
  picture::SweepShape shape_;
  bool sector_;
  int scale_;  ///< of bins to samples: 4-bit bins fill the palette, too
  std::shared_ptr<const picture::SweepImage> image_;
};

}  // namespace sonard::client
