// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/thin_things.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace sonard::render {

namespace {

constexpr double widest_m = 0.5;  // at 120 m a column of the coarsest grid is 0.2 m wide
constexpr std::size_t most_triangles = 200'000;
constexpr double columns_across = 8.0;  // 5.6 for a square bar, whose echo is then accurate to 1 dB

/// Disjoint sets of corners.
class Islands {
 public:
  explicit Islands(std::size_t corners) : parent_(corners) { std::iota(parent_.begin(), parent_.end(), 0U); }

  std::uint32_t island_of(std::uint32_t corner) {
    while (parent_[corner] != corner) {
      corner = parent_[corner] = parent_[parent_[corner]];
    }
    return corner;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[island_of(a)] = island_of(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// The corners of each island of connected triangles in a mesh. Corners at the same place count as one.
std::vector<std::vector<glm::dvec3>> islands_of(const TriangleMesh& mesh) {
  Islands islands(mesh.positions.size());
  std::map<std::tuple<float, float, float>, std::uint32_t> first_at;
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3& p = mesh.positions[i];
    islands.join(i, first_at.try_emplace({p.x, p.y, p.z}, i).first->second);
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    islands.join(mesh.indices[i], mesh.indices[i + 1]);
    islands.join(mesh.indices[i], mesh.indices[i + 2]);
  }
  std::map<std::uint32_t, std::vector<glm::dvec3>> corners;
  for (const std::uint32_t corner : mesh.indices) {
    corners[islands.island_of(corner)].emplace_back(mesh.positions[corner]);
  }
  std::vector<std::vector<glm::dvec3>> all;
  for (auto& [island, of_island] : corners) {
    all.push_back(std::move(of_island));
  }
  return all;
}

glm::dvec3 farthest_from(const glm::dvec3& place, const std::vector<glm::dvec3>& corners) {
  return *std::ranges::max_element(corners, {}, [&](const glm::dvec3& corner) {
    const glm::dvec3 way = corner - place;
    return glm::dot(way, way);
  });
}

/// nullopt if the island is wider than half a metre.
std::optional<ThinThing> thin_thing(std::size_t body, const std::vector<glm::dvec3>& corners) {
  const glm::dvec3 from_m = farthest_from(corners.front(), corners);
  const glm::dvec3 to_m = farthest_from(from_m, corners);
  const glm::dvec3 along = glm::normalize(to_m - from_m);
  double width_m = 0;
  for (const glm::dvec3& corner : corners) {
    width_m = std::max(width_m, glm::length(glm::cross(corner - from_m, along)));
  }
  return width_m > 0 && width_m <= widest_m ? std::optional(ThinThing{body, from_m, to_m, width_m})
                                            : std::nullopt;
}

/// The smallest even number that is at least `wanted`.
int even_columns(double wanted) {
  return 2 * static_cast<int>(std::ceil(std::min(wanted, 1e6) / 2));
}

}  // namespace

ThinThings::ThinThings(const World& world) {
  std::map<const TriangleMesh*, std::vector<ThinThing>> of_mesh;  // in the frame of the part
  for (std::size_t body = 0; body < world.bodies.size(); ++body) {
    T_world_body_.push_back(world.bodies[body].T_world_body);
    for (std::size_t i = 0; i < world.bodies[body].parts.size(); ++i) {
      const BodyPart& part = world.bodies[body].parts[i];
      if (world.is_terrain(body, i) || part.mesh->triangle_count() > most_triangles) {
        continue;
      }
      const auto [found, is_new] = of_mesh.try_emplace(part.mesh.get());
      for (const std::vector<glm::dvec3>& corners :
           is_new ? islands_of(*part.mesh) : std::vector<std::vector<glm::dvec3>>{}) {
        if (const std::optional<ThinThing> thing = thin_thing(0, corners)) {
          found->second.push_back(*thing);
        }
      }
      for (const ThinThing& thing : found->second) {
        things_.push_back(
            {body, part.T_body_part * thing.from_m, part.T_body_part * thing.to_m, thing.width_m});
      }
    }
  }
}

void ThinThings::set_body_pose(std::size_t body, const Pose& T_world_body) {
  T_world_body_[body] = T_world_body;
}

std::vector<int> ThinThings::least_columns(const Pose& T_world_sonar, const Aperture& aperture,
                                           double range_m) const {
  const std::vector<double>& edges_rad = aperture.beam_edges_rad;  // falling
  std::vector<int> columns(edges_rad.size() - 1, 0);
  for (const ThinThing& thing : things_) {
    const Pose& T_world_body = T_world_body_[thing.body];
    const auto in_sonar_frame = [&](const glm::dvec3& place_m) {
      return glm::conjugate(T_world_sonar.orientation) * (T_world_body * place_m - T_world_sonar.position_m);
    };
    const glm::dvec3 from_m = in_sonar_frame(thing.from_m);
    const glm::dvec3 to_m = in_sonar_frame(thing.to_m);
    const double along =
        std::clamp(-glm::dot(from_m, to_m - from_m) / glm::dot(to_m - from_m, to_m - from_m), 0.0, 1.0);
    const double nearest_m = glm::length(from_m + along * (to_m - from_m));
    if (nearest_m - thing.width_m > range_m || !(nearest_m > thing.width_m)) {
      continue;
    }
    // The far end appears thinnest.
    const double far_m = std::min(range_m, std::max(glm::length(from_m), glm::length(to_m)));
    const double one_rad = std::atan2(from_m.y, from_m.x);
    const double other_rad = std::atan2(to_m.y, to_m.x);
    const double around_rad = thing.width_m / nearest_m;
    const double port_rad = std::max(one_rad, other_rad) + around_rad;
    const double starboard_rad = std::min(one_rad, other_rad) - around_rad;
    if (port_rad - starboard_rad - 2 * around_rad > std::numbers::pi) {
      continue;  // it lies behind the sonar, outside every fan
    }
    // Beams whose port edge is beyond the starboard end, and whose starboard edge is not beyond the port end.
    const auto end = std::upper_bound(edges_rad.begin(), edges_rad.end(), starboard_rad, std::greater<>());
    auto edge = std::lower_bound(edges_rad.begin(), edges_rad.end(), port_rad, std::greater<>());
    edge = edge == edges_rad.begin() ? edge : edge - 1;
    for (; edge + 1 < edges_rad.end() && edge < end; ++edge) {
      int& of_beam = columns[static_cast<std::size_t>(edge - edges_rad.begin())];
      of_beam = std::max(of_beam, even_columns((edge[0] - edge[1]) * far_m / thing.width_m * columns_across));
    }
  }
  return columns;
}

std::string thin_things_not_looked_for(const World& world, const SonarSettings& settings) {
  constexpr auto sentence = "engine gpu may miss posts and bars thinner than a column in some pings, {}";
  if (settings.sampling.preset == Sampling::Preset::grid) {
    return fmt::format(sentence, "because `sampling: {preset: grid}` does not search for them");
  }
  if (settings.aperture.bearing == Aperture::Bearing::conical) {
    return fmt::format(sentence, "because `bearing: conical` does not search for them");
  }
  for (std::size_t body = 0; body < world.bodies.size(); ++body) {
    for (std::size_t i = 0; i < world.bodies[body].parts.size(); ++i) {
      const std::size_t triangles = world.bodies[body].parts[i].mesh->triangle_count();
      if (triangles > most_triangles && !world.is_terrain(body, i)) {
        return fmt::format(sentence,
                           fmt::format("if they are part of '{}': its mesh has {} triangles, and only meshes "
                                       "of up to {} triangles are searched",
                                       world.bodies[body].name, triangles, most_triangles));
      }
    }
  }
  return {};
}

}  // namespace sonard::render
