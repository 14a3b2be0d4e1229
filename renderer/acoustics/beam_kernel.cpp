#include "renderer/acoustics/beam_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonard::render {

namespace {
// Half-wavelength elements of a Hamming-tapered line array with a 1 degree beam at broadside
// (docs/physics.md 2.8).
constexpr double elements_for_one_degree = 155;
constexpr int most_taps_each_side = 16;

/// Response to a source `sine_offset` away in sine, 1 on the axis.
double array_amplitude(int elements, double sine_offset) {
  double sum = 0;
  double total = 0;
  for (int i = 0; i < elements; ++i) {
    const double taper = 0.54 - 0.46 * std::cos(2 * std::numbers::pi * i / (elements - 1));
    sum += taper * std::cos(std::numbers::pi * (i - 0.5 * (elements - 1)) * sine_offset);
    total += taper;
  }
  return sum / total;
}
}  // namespace

std::vector<float> receive_kernel(const Aperture& aperture) {
  const int beams = aperture.beam_count();
  if (beams < 2) {
    return {1.0F};
  }
  const double one_degree = std::numbers::pi / 180;
  const int elements = std::max(2, static_cast<int>(std::lround(elements_for_one_degree * one_degree /
                                                                aperture.receive_beamwidth_rad)));
  const auto middle = static_cast<std::size_t>(beams / 2);
  const double spacing =
      std::sin(aperture.beam_edges_rad[middle]) - std::sin(aperture.beam_edges_rad[middle + 1]);
  // The main lobe of a Hamming taper ends at 4 / elements in sine.
  const int half = std::clamp(static_cast<int>(4.0 / elements / spacing), 0, most_taps_each_side);
  std::vector<double> taps;
  double power = 0;
  for (int j = -half; j <= half; ++j) {
    taps.push_back(array_amplitude(elements, j * spacing));
    power += taps.back() * taps.back();
  }
  std::vector<float> kernel;
  std::transform(taps.begin(), taps.end(), std::back_inserter(kernel),
                 [&](double tap) { return static_cast<float>(tap / std::sqrt(power)); });
  return kernel;
}

}  // namespace sonard::render
