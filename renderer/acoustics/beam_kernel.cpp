#include "renderer/acoustics/beam_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/acoustics/line_array.hpp"

namespace sonard::render {

namespace {
constexpr int most_taps_each_side = 16;
}  // namespace

std::vector<float> receive_kernel(const Aperture& aperture) {
  const int beams = aperture.beam_count();
  if (beams < 2) {
    return {1.0F};
  }
  const LineArray array(aperture);
  const auto middle = static_cast<std::size_t>(beams / 2);
  const double spacing =
      std::sin(aperture.beam_edges_rad[middle]) - std::sin(aperture.beam_edges_rad[middle + 1]);
  // The main lobe of a Hamming taper ends at 4 / elements in sine.
  const int half = std::clamp(static_cast<int>(4.0 / array.elements() / spacing), 0, most_taps_each_side);
  std::vector<double> taps;
  double power = 0;
  for (int j = -half; j <= half; ++j) {
    taps.push_back(array.amplitude(j * spacing).real());
    power += taps.back() * taps.back();
  }
  std::vector<float> kernel;
  std::transform(taps.begin(), taps.end(), std::back_inserter(kernel),
                 [&](double tap) { return static_cast<float>(tap / std::sqrt(power)); });
  return kernel;
}

}  // namespace sonard::render
