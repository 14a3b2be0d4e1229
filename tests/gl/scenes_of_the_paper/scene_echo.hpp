// SPDX-License-Identifier: Apache-2.0
// Mean echoes of the scenes of docs/gallery.md without effects, and ranges of targets in them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "renderer/ping.hpp"
#include "renderer/renderer_options.hpp"
#include "tests/pictures/view.hpp"

namespace sonard::test {

/// A scene rendered by one engine with preset `fast`: a fan, or a sweep whose lines are its beams.
class SceneEcho {
 public:
  /// @param every_line of a sweep that is rendered; with 5, a fifth of the lines
  SceneEcho(const std::string& name, const render::RendererOptions& options, std::size_t every_line = 1);

  const pictures::View& view() const { return view_; }
  int beams() const { return beams_; }
  /// Azimuth of the middle of a beam or of a sweep's line, relative to the sonar at its time: positive to
  /// port.
  double azimuth_rad(int beam) const;
  /// The beam nearest to an azimuth.
  int beam_at(double azimuth_rad) const;
  double step_m() const { return step_m_; }

  double at(int beam, int line) const;
  /// Sum of the lines that begin in [from_m, to_m).
  double energy(int beam, double from_m, double to_m) const;
  /// Middle of the first line from `from_m` on with more than `threshold`; infinity if there is no such line.
  double first_range_m(int beam, double from_m, double threshold) const;
  /// Middle of the strongest line that begins in [from_m, to_m).
  double strongest_range_m(int beam, double from_m, double to_m) const;
  double strongest(int beam, double from_m, double to_m) const;
  /// Median of the lines that begin in [from_m, to_m).
  double median(int beam, double from_m, double to_m) const;

 private:
  int line_at(double range_m) const;

  pictures::View view_;
  int beams_ = 0;
  int lines_ = 0;
  double step_m_ = 0.0;
  std::vector<float> intensity_;  // [beam * lines_ + line]
};

}  // namespace sonard::test
