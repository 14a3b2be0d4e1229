// SPDX-License-Identifier: Apache-2.0
#include "renderer/aperture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "renderer/errors.hpp"

namespace sonard::render {

namespace {
constexpr double followed_beamwidths = 1.25;  // on either side: a little beyond the first null
// Upper limit: planes of constant elevation must not end near the vertical. Wide beams have their null
// beyond.
constexpr double highest_followed_rad = 80 * std::numbers::pi / 180;

double sinc(double x) {
  const double y = std::numbers::pi * x;
  return std::abs(y) < 1e-9 ? 1.0 : std::sin(y) / y;
}
}  // namespace

double Aperture::elevation_limit_rad() const {
  const double half = vertical_beamwidth_rad / 2;
  return elevation == Elevation::top_hat
             ? half
             : std::max(half, std::min(followed_beamwidths * vertical_beamwidth_rad, highest_followed_rad));
}

double Aperture::elevation_weight(double elevation_rad) const {
  if (elevation == Elevation::top_hat) {
    return 1.0;
  }
  // docs/physics.md 2.5: 0.443 makes the squared sinc one half at half the -3 dB width.
  const double amplitude = sinc(0.443 * std::sin(elevation_rad) / std::sin(vertical_beamwidth_rad / 2));
  const double one_way = amplitude * amplitude;
  return elevation == Elevation::sinc_two_way ? one_way * one_way : one_way;
}

double Aperture::pattern_height() const {
  constexpr int steps = 512;  // Simpson; the pattern is smooth
  const double limit = std::sin(elevation_limit_rad());
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const int share = i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2;
    sum += share * elevation_weight(std::asin(limit * (2.0 * i / steps - 1)));
  }
  return sum * 2 * limit / (3 * steps);
}

namespace {

/// Checks the values that only a receive array uses.
void check_array(const Aperture& aperture) {
  constexpr int most_fine_beams = 16;
  constexpr double quarter_turn_rad = std::numbers::pi / 2 + 1e-9;
  if (aperture.beam_edges_rad.front() > quarter_turn_rad ||
      aperture.beam_edges_rad.back() < -quarter_turn_rad) {
    throw RequestError("aperture: a straight array has no beams behind it");
  }
  if (aperture.fine_beams < 1 || aperture.fine_beams > most_fine_beams) {
    throw RequestError("aperture: " + std::to_string(aperture.fine_beams) + " fine beams, expected 1 to " +
                       std::to_string(most_fine_beams));
  }
  constexpr double narrowest_beam_rad = 1e-3;
  if (!(aperture.receive_beamwidth_rad >= narrowest_beam_rad) ||
      !(aperture.receive_beamwidth_rad <= std::numbers::pi)) {
    throw RequestError("aperture: receive beamwidth out of range");
  }
  const double errors = aperture.element_amplitude_sd + aperture.element_phase_sd_rad;
  if (!(aperture.element_amplitude_sd >= 0) || !(aperture.element_phase_sd_rad >= 0) ||
      !std::isfinite(errors)) {
    throw RequestError("aperture: the errors of the elements are not finite, or negative");
  }
}

}  // namespace

void check_aperture(const Aperture& aperture) {
  const auto& edges = aperture.beam_edges_rad;
  if (edges.size() < 2) {
    throw RequestError("aperture: no beams");
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!std::isfinite(edges[i]) || (i > 0 && !(edges[i] < edges[i - 1]))) {
      throw RequestError("aperture: beam edge " + std::to_string(i) + " is not finite or not falling");
    }
  }
  if (edges.front() - edges.back() > 2 * std::numbers::pi + 1e-9) {
    throw RequestError("aperture: the fan is wider than a full turn");
  }
  if (edges.front() > std::numbers::pi + 1e-9 || edges.back() < -std::numbers::pi - 1e-9) {
    throw RequestError("aperture: a beam lies across the backward azimuth; turn the sonar instead");
  }
  const double limit = aperture.elevation_limit_rad();
  if (!(limit > 0) || !(limit < std::numbers::pi / 2 * 0.97)) {
    throw RequestError("aperture: vertical beamwidth out of range");
  }
  if (aperture.azimuth == Aperture::Azimuth::array) {
    check_array(aperture);
  }
}

std::vector<double> equal_angle_edges(int beam_count, double width_rad) {
  std::vector<double> edges(static_cast<std::size_t>(beam_count) + 1);
  for (int i = 0; i <= beam_count; ++i) {
    edges[static_cast<std::size_t>(i)] = width_rad * (0.5 - static_cast<double>(i) / beam_count);
  }
  return edges;
}

std::vector<double> equal_sine_edges(int beam_count, double half_width_rad) {
  std::vector<double> edges(static_cast<std::size_t>(beam_count) + 1);
  const double sine = std::sin(half_width_rad);
  for (int i = 0; i <= beam_count; ++i) {
    edges[static_cast<std::size_t>(i)] = std::asin(sine * (1.0 - 2.0 * i / beam_count));
  }
  return edges;
}

}  // namespace sonard::render
