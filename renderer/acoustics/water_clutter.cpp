// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/water_clutter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "renderer/acoustics/decibels.hpp"
#include "renderer/acoustics/random.hpp"

namespace sonard::render {

namespace {

constexpr double farthest_m = 20.0;
constexpr double clutter_per_cell = 0.3;  // mean per cube of the world; a cube has one at most

/// One cube of the world, numbered along its axes.
std::uint64_t number_of(const glm::ivec3& cell) {
  const auto part = [](int i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)); };
  return (part(cell.x) * 0x9E3779B1U) ^ (part(cell.y) << 21U) ^ (part(cell.z) << 42U);
}

class Clutter {
 public:
  Clutter(const SonarSettings& settings, const Pose& T_world_sonar, EchoImage& image)
      : settings_(settings),
        T_world_sonar_(T_world_sonar),
        image_(image),
        upwards_(T_world_sonar.orientation * glm::dvec3(0, 0, 1)),
        limit_cosine_(std::cos(settings.aperture.elevation_limit_rad())),
        limit_sine_(std::sin(settings.aperture.elevation_limit_rad())),
        first_echo_(static_cast<std::size_t>(image.beams)) {
    for (int beam = 0; beam < image.beams; ++beam) {
      const float* row = row_of(beam);
      first_echo_[static_cast<std::size_t>(beam)] =
          static_cast<int>(std::find_if(row, row + image.bins, [](float echo) { return echo > 0; }) - row);
    }
  }

  /// False if nothing within `around_m` metres of a point is received.
  bool may_receive(const glm::dvec3& position_m, double around_m) const {
    const glm::dvec3 from_sonar_m = position_m - T_world_sonar_.position_m;
    const double up_m = std::abs(glm::dot(from_sonar_m, upwards_));
    const double distance2 = glm::dot(from_sonar_m, from_sonar_m);
    const double across_m = std::sqrt(std::max(0.0, distance2 - up_m * up_m));
    const double reach_m = farthest_m + around_m;
    return distance2 < reach_m * reach_m && up_m * limit_cosine_ - across_m * limit_sine_ < around_m;
  }

  void add(const glm::dvec3& position_m, double strength) {
    const glm::dvec3 p =
        glm::conjugate(T_world_sonar_.orientation) * (position_m - T_world_sonar_.position_m);
    const double range_m = glm::length(p);
    const auto line = static_cast<int>(range_m / settings_.range.step_m);
    if (!(range_m < farthest_m) || !(range_m > nearest_depth_m) || line >= image_.bins) {
      return;
    }
    const int beam = beam_of(std::atan2(p.y, p.x));
    const double elevation_rad = std::asin(p.z / range_m);
    if (beam < 0 || std::abs(elevation_rad) > settings_.aperture.elevation_limit_rad() ||
        line >= first_echo_[static_cast<std::size_t>(beam)]) {
      return;
    }
    row_of(beam)[line] += static_cast<float>(strength * settings_.aperture.elevation_weight(elevation_rad) /
                                             (range_m * range_m));
  }

 private:
  float* row_of(int beam) {
    return &image_.intensity[static_cast<std::size_t>(beam) * static_cast<std::size_t>(image_.bins)];
  }

  /// -1 outside the fan.
  int beam_of(double azimuth_rad) const {
    const std::vector<double>& edges = settings_.aperture.beam_edges_rad;  // falling
    const auto below = std::lower_bound(edges.begin(), edges.end(), azimuth_rad, std::greater<>());
    return below == edges.end() ? -1 : static_cast<int>(below - edges.begin()) - 1;
  }

  const SonarSettings& settings_;
  const Pose& T_world_sonar_;
  EchoImage& image_;
  glm::dvec3 upwards_;  ///< the sonar's z axis in the world
  double limit_cosine_, limit_sine_;
  std::vector<int> first_echo_;  ///< line of the first echo, per beam
};

}  // namespace

void add_water_clutter(const SonarSettings& settings, const Pose& T_world_sonar, std::uint64_t seed,
                       EchoImage& image) {
  const WaterClutter& water = settings.physical.water_clutter;
  if (settings.model == Model::paper || !settings.transmit || !(water.density_per_m3 > 0)) {
    return;
  }
  const double edge_m = std::cbrt(clutter_per_cell / water.density_per_m3);
  const double reach_m = std::min(farthest_m, settings.range.max_range_m());
  const glm::dvec3& at = T_world_sonar.position_m;
  const glm::ivec3 low(glm::floor((at - reach_m) / edge_m));
  const glm::ivec3 high(glm::floor((at + reach_m) / edge_m));
  const double mean = decibels_to_power(water.target_strength_db);
  const double half_diagonal_m = 1.001 * std::sqrt(0.75) * edge_m;
  Clutter clutter(settings, T_world_sonar, image);
  for (glm::ivec3 cell = low; cell.z <= high.z; ++cell.z) {
    for (cell.y = low.y; cell.y <= high.y; ++cell.y) {
      for (cell.x = low.x; cell.x <= high.x; ++cell.x) {
        if (!clutter.may_receive((glm::dvec3(cell) + 0.5) * edge_m, half_diagonal_m)) {
          continue;
        }
        const RandomKey own = make_random_key(seed, 0, RandomField::water_clutter, number_of(cell));
        if (uniform_number(own, 0) >= clutter_per_cell) {
          continue;
        }
        const glm::dvec3 inside(uniform_number(own, 1), uniform_number(own, 2), uniform_number(own, 3));
        clutter.add((glm::dvec3(cell) + inside) * edge_m, -mean * std::log(1 - uniform_number(own, 4)));
      }
    }
  }
}

}  // namespace sonard::render
