// SPDX-License-Identifier: Apache-2.0
// Sweeps of a scanning head, and their pictures.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "renderer/picture/sweep_image.hpp"

namespace sonard::client {

/// A full turn, or a sector from one limit to the other.
struct Sweep {
  std::uint64_t number = 0;  ///< 0, 1, 2, ...
  std::vector<picture::SweepLine> lines;
  std::uint64_t lines_missed = 0;
};

/// The lines of `sweep`, and lines of `before` at the bearings that `sweep` has not reached. A sonar screen
/// shows this in the middle of a sweep.
Sweep with_lines_before(Sweep sweep, const std::optional<Sweep>& before);

/// Values that all sweeps of a scan share.
struct SweepForm {
  std::string title;  ///< the type of head
  std::string lines;  ///< the head's word for its lines, "lines"
  picture::SweepShape shape;
  bool sector = false;
  int scale = 1;  ///< factor for samples when drawn, so that 4-bit samples use the whole palette
  int radius_px = 0;
};

/// Queues pictures of a scan: turn-<name>.png (for a sector fan-<name>.png) and polar-<name>.png.
class SweepPictures {
 public:
  /// @param every keep the pictures of each n-th turn; 0: only of the last
  SweepPictures(SweepForm form, std::uint64_t every);

  /// A complete sweep.
  void write(ImageWriter& writer, const Sweep& sweep);
  /// Draws the lines of an unfinished sweep, and lines of the last one at the bearings not reached yet.
  void refresh(ImageWriter& writer, const Sweep& current) const;
  /// At the end of the program: draws the unfinished sweep if no sweep was completed.
  void finish(ImageWriter& writer, const Sweep& current) const;

 private:
  std::vector<Picture> of(const Sweep& sweep, const std::vector<std::string>& names) const;

  SweepForm form_;
  std::uint64_t every_;
  std::shared_ptr<const picture::SweepImage> image_;
  std::optional<Sweep> last_;  ///< the last complete sweep
};

}  // namespace sonard::client
