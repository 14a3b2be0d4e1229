// SPDX-License-Identifier: Apache-2.0
#include "renderer/multipath/ghost_paths.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

namespace sonard::render {

namespace {

constexpr int parts_across = packet_side;  // per cell at an edge
constexpr int parts_up = 2 * packet_side;
constexpr int rows_per_block = 32;     // an upright edge divides all cells of a column: too much for one job
constexpr double corner_reach = 1.5;   // largest angle between a ray and a corner it finds, in cell diagonals
constexpr double least_cosine = 1e-3;  // limits the range extent of surfaces seen edge-on, without energy

/// Change of range and bearing of a path over its cell.
struct Slopes {
  double range_m = 0.0, bearing_rad = 0.0;
};

/// Equal for neighbours that hit the same surface: its number, and for a flat surface also its rounded
/// normal, which separates two walls of one part. The facets of a curved surface are one surface.
std::uint64_t surface_code(const PathScene& scene, const PathHit& hit) {
  if (!scene.is_flat(hit)) {
    return hit.surface;
  }
  const auto part = [](double x) { return static_cast<std::uint64_t>(std::lround(4 * x) + 4); };
  const std::uint64_t direction = 1 + part(hit.normal.x) + 9 * (part(hit.normal.y) + 9 * part(hit.normal.z));
  return (direction << 32U) + hit.surface;
}

std::uint64_t mixed(std::uint64_t key, std::uint64_t next) {
  key = (key ^ next) * 0x9E3779B97F4A7C15U;
  return key ^ (key >> 29U);
}

int blocks_per_column(const PathFan& fan) {
  return (fan.rows() + rows_per_block - 1) / rows_per_block;
}

/// An echo around a range, spread over `a_m` and independently over `b_m`.
EchoPatch spread_patch(double range_m, double a_m, double b_m, double echo) {
  const auto wide = static_cast<float>(std::max(std::abs(a_m), std::abs(b_m)));
  const auto narrow = static_cast<float>(std::min(std::abs(a_m), std::abs(b_m)));
  EchoPatch patch;
  patch.range_a_m = static_cast<float>(range_m) - 0.5F * wide;
  patch.range_b_m = static_cast<float>(range_m) + 0.5F * wide;
  patch.smear_a_m = patch.smear_b_m = narrow;
  patch.echo = static_cast<float>(echo);
  return patch;
}

}  // namespace

struct GhostPaths::Ping {
  const PathScene& scene;
  const PathFan& fan;
  glm::dquat R_world_sonar, R_sonar_world;
  PathLimits limits;

  double elevation_weight(const glm::dvec3& direction) const {
    return fan.aperture().elevation_weight(std::asin(std::clamp(direction.z, -1.0, 1.0)));
  }
  double mirror_gain(const PathHit& hit) const {
    if (!limits.meshes_mirror && hit.surface != no_part) {
      return 0.0;
    }
    const double gain = scene.mirror(hit).gain(hit.cosine, limits.wavelength_m);
    return gain > limits.least_gain ? gain : 0.0;
  }
};

const std::vector<GhostPaths::Result>& GhostPaths::follow(const PathScene& scene, const PathFan& fan,
                                                          const Pose& T_world_sonar,
                                                          const PathLimits& limits) {
  const Ping ping{scene, fan, T_world_sonar.orientation, glm::conjugate(T_world_sonar.orientation), limits};
  const auto columns = static_cast<std::size_t>(fan.columns());
  const auto rows = static_cast<std::size_t>(fan.rows());
  keys_.resize(columns * rows);
  paths_.resize(columns);
  const int blocks = blocks_per_column(fan);
  results_.resize(columns * static_cast<std::size_t>(blocks));
  for (std::vector<Path>& paths : paths_) {
    paths.clear();
  }
  for (Result& result : results_) {
    result.patches.clear();
    result.corners.clear();
  }
  workers_.run((fan.columns() + packet_side - 1) / packet_side,
               [&](int job) { follow_columns(ping, job * packet_side); });
  workers_.run(fan.columns() * blocks,
               [&](int block) { refine(ping, block / blocks, block % blocks * rows_per_block); });
  return results_;
}

GhostPaths::Result& GhostPaths::result_of(const PathFan& fan, int column, int row) {
  return results_[static_cast<std::size_t>(column * blocks_per_column(fan) + row / rows_per_block)];
}

/// Follows packet_side columns.
void GhostPaths::follow_columns(const Ping& ping, int first_column) {
  PathScene::Directions directions;
  std::array<PathHit, packet_size> mirrors;
  for (int first_row = 0; first_row < ping.fan.rows(); first_row += packet_side) {
    const auto for_each = [&](const auto& what) {
      for (int i = 0; i < packet_size; ++i) {
        what(static_cast<std::size_t>(i), first_column + i % packet_side, first_row + i / packet_side);
      }
    };
    for_each([&](std::size_t i, int column, int row) {
      directions[i] = ping.R_world_sonar * ping.fan.direction(std::min(column, ping.fan.columns() - 1),
                                                              std::min(row, ping.fan.rows() - 1));
    });
    ping.scene.trace_from_sonar(directions, ping.limits.max_range_m, mirrors);
    for_each([&](std::size_t i, int column, int row) {
      if (column < ping.fan.columns() && row < ping.fan.rows()) {
        Path path;
        path.row = row;
        path.mirror = mirrors[i];
        const auto c = static_cast<std::size_t>(column);
        keys_[index(ping.fan, column, row)] =
            follow_on(ping, directions[i], path, result_of(ping.fan, column, row));
        if (path.target.distance_m > 0) {
          paths_[c].push_back(path);
        }
      }
    });
  }
}

GhostPaths::Result GhostPaths::search(const PathScene& scene, const PathFan& fan, const Pose& T_world_sonar,
                                      const PathLimits& limits, const std::vector<FanCell>& cells) {
  const Ping ping{scene, fan, T_world_sonar.orientation, glm::conjugate(T_world_sonar.orientation), limits};
  Result result;
  for (const FanCell& cell : cells) {
    Path path;
    follow_one(ping, cell, path, result);
  }
  return result;
}

/// Refines a block of cells, from `first_row` on.
void GhostPaths::refine(const Ping& ping, int column, int first_row) {
  Result& result = result_of(ping.fan, column, first_row);
  const std::vector<Path>& paths = paths_[static_cast<std::size_t>(column)];
  auto path = std::ranges::lower_bound(paths, first_row, {}, &Path::row);
  const int end_row = std::min(first_row + rows_per_block, ping.fan.rows());
  for (int row = first_row; row < end_row; ++row) {
    const FanCell cell = ping.fan.cell(column, row);
    const bool has_path = path != paths.end() && path->row == row;
    if (differs_from_neighbours(ping, column, row)) {
      for (int part_row = 0; part_row < parts_up; part_row += packet_side) {
        follow_parts(ping, cell, part_row, result);
      }
    } else if (has_path) {
      add_echoes(ping, cell, *path, result);
    }
    path += has_path ? 1 : 0;
  }
}

void GhostPaths::follow_parts(const Ping& ping, const FanCell& cell, int first_row, Result& result) {
  std::array<FanCell, packet_size> parts;
  PathScene::Directions directions;
  for (int i = 0; i < packet_size; ++i) {
    const auto k = static_cast<std::size_t>(i);
    parts[k] = cell.part(i % parts_across, first_row + i / parts_across, parts_across, parts_up);
    directions[k] = ping.R_world_sonar * parts[k].direction();
  }
  std::array<PathHit, packet_size> mirrors;
  ping.scene.trace_from_sonar(directions, ping.limits.max_range_m, mirrors);
  for (std::size_t k = 0; k < packet_size; ++k) {
    Path path;
    path.mirror = mirrors[k];
    follow_on(ping, directions[k], path, result);
    add_echoes(ping, parts[k], path, result);
  }
}

bool GhostPaths::differs_from_neighbours(const Ping& ping, int column, int row) const {
  const auto key = [&](int c, int r) { return keys_[index(ping.fan, c, r)]; };
  const std::uint64_t own = key(column, row);
  return (row > 0 && key(column, row - 1) != own) ||
         (row + 1 < ping.fan.rows() && key(column, row + 1) != own) ||
         (column > 0 && key(column - 1, row) != own) ||
         (column + 1 < ping.fan.columns() && key(column + 1, row) != own);
}

/// Follows a path from the sonar. @return see follow_on()
std::uint64_t GhostPaths::follow_one(const Ping& ping, const FanCell& cell, Path& path, Result& result) {
  const glm::dvec3 direction = ping.R_world_sonar * cell.direction();
  if (!ping.scene.trace({}, {}, direction, ping.limits.max_range_m, path.mirror)) {
    return 0;
  }
  return follow_on(ping, direction, path, result);
}

/// Follows a path on from its first hit in `direction`, if it has one.
/// @return a number for the surfaces that were hit; 0 without a flat mirror
std::uint64_t GhostPaths::follow_on(const Ping& ping, const glm::dvec3& direction, Path& path,
                                    Result& result) {
  if (!(path.mirror.distance_m > 0)) {
    return 0;
  }
  path.gain = ping.mirror_gain(path.mirror);
  if (!(path.gain > 0)) {
    return 0;
  }
  // Images in a curved mirror are wide and need no finer rays at their edges.
  const bool is_flat = ping.scene.is_flat(path.mirror);
  const std::uint64_t key = is_flat ? mixed(1, surface_code(ping.scene, path.mirror)) : 0;
  // With the straight line back, the path is at most twice the range.
  const double farthest_m = 2 * ping.limits.max_range_m - path.mirror.distance_m;
  PathHit target;
  if (!ping.scene.trace(path.mirror.position_m, path.mirror.normal, reflected(direction, path.mirror.normal),
                        farthest_m, target)) {
    return key;
  }
  path.target = target;
  path.target_seen = ping.fan.contains(ping.R_sonar_world * glm::normalize(target.position_m)) &&
                     ping.scene.sees_sonar(target);
  find_corners(ping, direction, path, result);
  return !is_flat ? 0 : mixed(mixed(key, surface_code(ping.scene, target)), path.target_seen ? 1 : 2);
}

/// A path returns straight to the sonar if the image of the sonar in its mirrors lies ahead.
void GhostPaths::find_corners(const Ping& ping, const glm::dvec3& direction, const Path& path,
                              Result& result) {
  if (!(ping.mirror_gain(path.target) > 0) || !ping.scene.is_flat(path.mirror) ||
      !ping.scene.is_flat(path.target)) {
    return;
  }
  const double reach = std::cos(corner_reach * ping.fan.diagonal_rad());
  const auto try_image = [&](const glm::dvec3& image_m) {
    const double distance_m = glm::length(image_m);
    if (distance_m < 2 * ping.limits.max_range_m && glm::dot(image_m, direction) > reach * distance_m) {
      result.corners.push_back({image_m});
    }
  };
  try_image(mirrored(mirrored({}, path.target), path.mirror));
  const glm::dvec3 second = reflected(direction, path.mirror.normal);
  PathHit third;
  if (ping.scene.trace(path.target.position_m, path.target.normal, reflected(second, path.target.normal),
                       2 * ping.limits.max_range_m, third) &&
      ping.mirror_gain(third) > 0 && ping.scene.is_flat(third)) {
    try_image(mirrored(mirrored(mirrored({}, third), path.target), path.mirror));
  }
}

/// Adds the paths out by the mirror and straight back, straight out and back by the mirror, and both by the
/// mirror.
void GhostPaths::add_echoes(const Ping& ping, const FanCell& cell, const Path& path, Result& result) {
  if (!(path.target.distance_m > 0)) {
    return;
  }
  const glm::dvec3& mirror_normal = path.mirror.normal;
  const glm::dvec3& target_normal = path.target.normal;
  const double by_mirror_m = path.mirror.distance_m + path.target.distance_m;
  const double straight_m = glm::length(path.target.position_m);
  const glm::dvec3 out = reflected(ping.R_world_sonar * cell.direction(), mirror_normal);
  const glm::dvec3 straight = path.target.position_m / straight_m;
  const glm::dvec3 p = ping.R_sonar_world * path.target.position_m;
  const double cosine = std::max(path.target.cosine, least_cosine);

  // Change of the two ranges and of the target's bearing over the cell: the mirror's plane turns the rays,
  // and they end at the target's plane (docs/physics.md 2.3, equation 2).
  const auto slopes = [&](const glm::dvec3& step, double& by_mirror_step_m) {
    const glm::dvec3 turned = reflected(ping.R_world_sonar * step, mirror_normal);
    by_mirror_step_m = by_mirror_m * glm::dot(target_normal, turned) / cosine;
    const glm::dvec3 moved = by_mirror_step_m * out + by_mirror_m * turned;
    const glm::dvec3 in_sonar = ping.R_sonar_world * moved;
    return Slopes{0.5 * (by_mirror_step_m + glm::dot(straight, moved)),
                  (p.x * in_sonar.y - p.y * in_sonar.x) / (p.x * p.x + p.y * p.y)};
  };
  double by_mirror_width_m = 0.0, by_mirror_height_m = 0.0;
  const Slopes along_width = slopes(cell.along_width(), by_mirror_width_m);
  const Slopes along_height = slopes(cell.along_height(), by_mirror_height_m);

  const double mu = ping.scene.lambert_mu(path.target);
  const double out_weight = ping.fan.aperture().elevation_weight(cell.elevation_rad);
  // By the mirror both ways: the echo has the range of the target's image.
  if (ping.scene.is_flat(path.mirror)) {
    result.patches.push_back({cell.beam, spread_patch(by_mirror_m, by_mirror_width_m, by_mirror_height_m,
                                                      mu * path.target.cosine * cell.solid_angle() *
                                                          path.gain * path.gain * out_weight)});
  }
  if (!path.target_seen) {
    return;
  }
  // By the mirror one way: the range is the mean of both ways. Each line later gets the loss of its own
  // range, so the echo is scaled by the spreading over the straight way.
  const double range_m = 0.5 * (by_mirror_m + straight_m);
  const double back_weight = ping.elevation_weight(p / straight_m);
  const double echo = mu * -glm::dot(target_normal, straight) * cell.solid_angle() * path.gain *
                      std::sqrt(out_weight * back_weight) * (range_m / straight_m) * (range_m / straight_m);
  const bool across = std::abs(along_width.bearing_rad) >= std::abs(along_height.bearing_rad);
  const Slopes& turning = across ? along_width : along_height;
  const Slopes& other = across ? along_height : along_width;
  const double half_rad = std::max(1e-9, 0.5 * (std::abs(turning.bearing_rad) + std::abs(other.bearing_rad)));
  const double bearing_rad = std::atan2(p.y, p.x);
  const auto& edges = ping.fan.aperture().beam_edges_rad;
  const auto beam_at = [&](double azimuth_rad) {
    return *ping.fan.beam_of(std::clamp(azimuth_rad, edges.back(), edges.front()));
  };
  for (int beam = beam_at(bearing_rad + half_rad); beam <= beam_at(bearing_rad - half_rad); ++beam) {
    const double from = std::min(bearing_rad + half_rad, edges[static_cast<std::size_t>(beam)]);
    const double to = std::max(bearing_rad - half_rad, edges[static_cast<std::size_t>(beam) + 1]);
    if (!(from > to)) {
      continue;
    }
    const double share = (from - to) / (2 * half_rad);
    const double offset =
        turning.bearing_rad == 0.0
            ? 0.0
            : std::clamp((0.5 * (from + to) - bearing_rad) / turning.bearing_rad, -0.5, 0.5);
    EchoPatch patch = spread_patch(range_m + turning.range_m * offset, turning.range_m * share, other.range_m,
                                   echo * share);
    if (beam == cell.beam) {
      patch.echo *= 4.0F;  // a path and its reverse are equally long, so their pressures add
      result.patches.push_back({beam, patch});
    } else {
      result.patches.push_back({beam, patch});
      result.patches.push_back({cell.beam, patch});
    }
  }
}

}  // namespace sonard::render
