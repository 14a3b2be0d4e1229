// SPDX-License-Identifier: Apache-2.0
// Turns of a scanning head, and their pictures.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "renderer/picture/sweep_image.hpp"

namespace sonard::client {

/// One full turn, or in a sector one way from limit to limit.
struct Sweep {
  std::uint64_t number = 0;  ///< 0, 1, 2, ...
  std::vector<picture::SweepLine> lines;
  std::uint64_t lines_missed = 0;
};

/// What a screen shows in the middle of a sweep: behind the lines of `before` at bearings that `sweep` has
/// not come to, those of `sweep`.
Sweep with_lines_before(Sweep sweep, const std::optional<Sweep>& before);

/// What is the same for all turns of a scan.
struct SweepForm {
  std::string title;  ///< the kind of head
  std::string lines;  ///< what it calls them, "lines"
  picture::SweepShape shape;
  bool sector = false;
  int scale = 1;  ///< of samples when they are drawn: those of 4 bits fill the palette, too
  int radius_px = 0;
};

/// Has the pictures of a scan drawn: turn-<name>.png, or fan-<name>.png of a sector, and polar-<name>.png.
class SweepPictures {
 public:
  /// @param every keep those of each n-th turn; 0: only of the last
  SweepPictures(SweepForm form, std::uint64_t every);

  /// A turn that is whole.
  void write(ImageWriter& writer, const Sweep& sweep);
  /// For whoever looks at the folder during a turn: the lines of this turn, and those of the last one where
  /// this one has not come yet.
  void refresh(ImageWriter& writer, const Sweep& current) const;
  /// At the end: the turn that was begun, where none was whole.
  void finish(ImageWriter& writer, const Sweep& current) const;

 private:
  std::vector<Picture> of(const Sweep& sweep, const std::vector<std::string>& names) const;

  SweepForm form_;
  std::uint64_t every_;
  std::shared_ptr<const picture::SweepImage> image_;
  std::optional<Sweep> last_;  ///< the last whole one
};

}  // namespace sonard::client
