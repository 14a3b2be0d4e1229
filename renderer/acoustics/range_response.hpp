// What the length of the pulse does to the mean echo: it spreads along the range.
#pragma once

#include <vector>

#include "renderer/sonar_renderer.hpp"

namespace sonard::render {

/// Response of a matched chirp, sinc^2(x / cell) with the cell c / 2B, where an echo lies anywhere in its
/// line: averaged over the line, and over that in which it is heard (docs/physics.md 2.7). Out to 16 cells to
/// either side; of an echo nothing is lost.
class RangeResponse {
 public:
  /// Spreads nothing.
  RangeResponse() = default;
  /// @param cell_m first zero of the response; 0: none
  RangeResponse(double cell_m, double step_m);

  /// Shares of an echo in its own line and the lines to one side of it; 0: nothing is spread.
  int taps() const { return static_cast<int>(share_.size()); }
  /// Share that is heard `lines` away from where it is.
  double share(int lines) const { return static_cast<double>(share_[static_cast<std::size_t>(lines)]); }

  /// What would be heard beyond the ends of the image is left out.
  void apply(const EchoImage& echo, EchoImage& out) const;

 private:
  std::vector<float> share_;
};

}  // namespace sonard::render
