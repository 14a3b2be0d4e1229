// What the length of the pulse does to the mean echo: it spreads along the range.
#pragma once

#include <vector>

#include "renderer/ping.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Response of a pulse, as PhysicalModel::Pulse has them, where an echo lies anywhere in its line: averaged
/// over the line, and over that in which it is heard (docs/physics.md 2.6). Chirps are followed out to 16
/// cells to either side; of an echo nothing is lost.
class RangeResponse {
 public:
  using Pulse = PhysicalModel::Pulse;

  /// Spreads nothing.
  RangeResponse() = default;
  /// @param cell_m PhysicalModel::range_cell_m; 0: spreads nothing
  RangeResponse(Pulse pulse, double cell_m, double step_m);

  /// Shares of an echo in its own line and the lines to one side of it; 0: nothing is spread.
  int taps() const { return static_cast<int>(share_.size()); }
  /// Share that is heard `lines` away from where it is.
  double share(int lines) const { return static_cast<double>(share_[static_cast<std::size_t>(lines)]); }

  /// Share that is heard outside of the line where the echo is.
  double share_outside() const { return share_.empty() ? 0.0 : 1 - share(0); }

  /// What would be heard beyond the ends of the image is left out. What `out` holds is used as memory.
  void apply(const EchoImage& echo, EchoImage& out, WorkerPool& workers) const;

 private:
  std::vector<float> share_;
};

}  // namespace sonard::render
