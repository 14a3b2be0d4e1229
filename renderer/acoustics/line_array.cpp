// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/line_array.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sonard::render {

namespace {

using Taper = Aperture::Taper;

constexpr double kaiser_beta = 2.5;

/// Number of elements that make a beam of one degree. For Hamming it fits the correlation of recorded
/// speckle, 4 % more than for the -3 dB width (docs/physics.md 2.8).
double elements_for_one_degree(Taper taper) {
  switch (taper) {
    case Taper::uniform:
      return 101;
    case Taper::kaiser:
      return 120;
    case Taper::hann:
      return 166;
    case Taper::hamming:
      break;
  }
  return 155;
}

/// Weight at x, from -1 at one end of the array to 1 at the other.
double taper_weight(Taper taper, double x) {
  switch (taper) {
    case Taper::uniform:
      return 1.0;
    case Taper::kaiser:
      return std::cyl_bessel_i(0.0, kaiser_beta * std::sqrt(std::max(0.0, 1 - x * x))) /
             std::cyl_bessel_i(0.0, kaiser_beta);
    case Taper::hann:
      return 0.5 + 0.5 * std::cos(std::numbers::pi * x);
    case Taper::hamming:
      break;
  }
  return 0.54 + 0.46 * std::cos(std::numbers::pi * x);
}

}  // namespace

std::vector<double> taper_weights(Taper taper, int elements) {
  std::vector<double> weights;
  for (int i = 0; i < elements; ++i) {
    weights.push_back(taper_weight(taper, 2.0 * i / (elements - 1) - 1));
  }
  return weights;
}

int element_count(const Aperture& aperture) {
  const double degrees = aperture.receive_beamwidth_rad * 180 / std::numbers::pi;
  return std::max(2, static_cast<int>(std::lround(elements_for_one_degree(aperture.taper) / degrees)));
}

LineArray::LineArray(const Aperture& aperture) {
  const std::vector<double> taper = taper_weights(aperture.taper, element_count(aperture));
  const double sum = std::accumulate(taper.begin(), taper.end(), 0.0);
  std::transform(taper.begin(), taper.end(), std::back_inserter(weights_),
                 [sum](double weight) { return weight / sum; });
}

LineArray::LineArray(const Aperture& aperture, RandomKey key) : LineArray(aperture) {
  const double amplitude_sd = aperture.element_amplitude_sd;
  const double phase_sd = aperture.element_phase_sd_rad;
  std::vector<float> amplitude(weights_.size());
  std::vector<float> phase(weights_.size());
  fill_complex_gaussian(key, 0, elements(), amplitude.data(), phase.data());
  double squares = 0;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    squares += std::norm(weights_[i]);
    // Real and imaginary part of CN(0, 1) have variance 1/2.
    const double gain = 1 + std::numbers::sqrt2 * amplitude_sd * static_cast<double>(amplitude[i]);
    weights_[i] *= gain * std::polar(1.0, std::numbers::sqrt2 * phase_sd * static_cast<double>(phase[i]));
  }
  // E|g e^(i p)|^2 - |E g e^(i p)|^2 of each element, equal in all directions.
  mean_error_power_ = (1 + amplitude_sd * amplitude_sd - std::exp(-phase_sd * phase_sd)) * squares;
}

std::complex<double> LineArray::amplitude(double sine_offset) const {
  const double step = std::numbers::pi * sine_offset;
  const std::complex<double> turn = std::polar(1.0, step);
  std::complex<double> phasor = std::polar(1.0, -0.5 * step * (elements() - 1));
  std::complex<double> sum;
  for (const std::complex<double>& weight : weights_) {
    sum += weight * phasor;
    phasor *= turn;
  }
  return sum;
}

}  // namespace sonard::render
