// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/scanned_speckle.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

#include "renderer/acoustics/correlated_field.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

// The correlation is a Gaussian of the difference in bearing, so the weights of the cells are a Gaussian
// narrower by sqrt 2. With two cells per correlation width the sum is as accurate as the integral.
constexpr double cells_per_correlation = 2.0;
constexpr double most_scan_cells = 1e6;
constexpr double reach_correlations = 2.0;  // exp(-2 * 4): weights beyond are below 1e-3

SONARD_SIMD_CLONES
void add_weighed(const float* __restrict row, float weight, int count, float* __restrict sum) {
  for (int i = 0; i < count; ++i) {
    sum[i] += weight * row[i];
  }
}

}  // namespace

ScanPose::ScanPose(const Pose& T_world_sonar)
    : position_m(T_world_sonar.position_m), axis(T_world_sonar.orientation * glm::dvec3(0, 0, 1)) {
  const glm::dvec3 ahead = T_world_sonar.orientation * glm::dvec3(1, 0, 0);
  const glm::dvec3 any = std::abs(axis.z) > 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 from = glm::normalize(any - glm::dot(any, axis) * axis);
  bearing_rad = std::atan2(glm::dot(axis, glm::cross(from, ahead)), glm::dot(from, ahead));
}

ScannedSpeckle::ScannedSpeckle(double beamwidth_rad, int lines)
    : lines_(lines), fresh_(lines), sum_(lines), out_(lines) {
  const double turn = 2 * std::numbers::pi;
  cell_count_ = static_cast<int>(
      std::clamp(std::round(turn / beamwidth_rad * cells_per_correlation), 1.0, most_scan_cells));
  correlation_rad_ = turn / cell_count_ * cells_per_correlation;
}

void ScannedSpeckle::fade(double decay) {
  for (auto& [number, cell] : cells_) {
    cell.fade(decay);
  }
}

/// Adds the cell if it is missing; a new cell takes its first innovation whole.
SpeckleField& ScannedSpeckle::cell_at(int number) {
  const auto [found, is_new] = cells_.try_emplace(number, lines_);
  if (is_new) {
    found->second.ensure_lines(1);
  }
  return found->second;
}

Phasors ScannedSpeckle::at(double bearing_rad, const PulseCorrelation& pulse, RandomKey key,
                           const SkipSwitches& skip, SkipCounts& skipped) {
  const double place = bearing_rad / correlation_rad_ * cells_per_correlation;
  const int reach =
      std::min(static_cast<int>(reach_correlations * cells_per_correlation), (cell_count_ - 1) / 2);
  const int middle = static_cast<int>(std::lround(place));
  std::vector<double> weights;
  double power = 0;
  for (int cell = middle - reach; cell <= middle + reach; ++cell) {
    const double apart = (cell - place) / cells_per_correlation;
    weights.push_back(std::exp(-2 * apart * apart));
    power += weights.back() * weights.back();
  }
  std::fill_n(sum_.real(), lines_, 0.0F);
  std::fill_n(sum_.imaginary(), lines_, 0.0F);
  for (int i = 0; i <= 2 * reach; ++i) {
    const int number = ((middle - reach + i) % cell_count_ + cell_count_) % cell_count_;
    SpeckleField& cell = cell_at(number);
    const bool rests = cell.is_current(0) && skip.on(SkipRule::unmoved_speckle);
    skipped.add(SkipRule::unmoved_speckle, rests ? 1 : 0);
    if (!rests) {
      fresh_.draw(key, number);
      cell.evolve(0, fresh_.real(), fresh_.imaginary());
    }
    const auto weight = static_cast<float>(weights[static_cast<std::size_t>(i)] / std::sqrt(power));
    add_weighed(cell.real(0), weight, lines_, sum_.real());
    add_weighed(cell.imaginary(0), weight, lines_, sum_.imaginary());
  }
  return correlate_along_range(sum_, lines_ - 2 * pulse.reach(), pulse, out_);
}

}  // namespace sonard::render
