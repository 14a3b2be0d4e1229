// SPDX-License-Identifier: Apache-2.0
#include "renderer/multipath/mirror_survey.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace sonard::render {

namespace {
constexpr std::size_t triangles_per_group = 32;
constexpr double one_plane_rad = 1e-4;
}  // namespace

MirrorSurvey::Ball MirrorSurvey::ball_around(const TriangleMesh& mesh) {
  glm::vec3 low(mesh.positions.empty() ? glm::vec3(0) : mesh.positions[0]), high(low);
  for (const glm::vec3& position : mesh.positions) {
    low = glm::min(low, position);
    high = glm::max(high, position);
  }
  return {0.5 * glm::dvec3(low + high), 0.5 * static_cast<double>(glm::length(high - low))};
}

MirrorSurvey::MirrorSurvey(const World& world) {
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    for (std::size_t p = 0; p < world.bodies[b].parts.size(); ++p) {
      const BodyPart& part = world.bodies[b].parts[p];
      const Mirror mirror(part.material);
      // A part that mirrors too little head-on and without roughness never mirrors.
      if (mirror.pressure_reflection * mirror.pressure_reflection > least_mirror_gain) {
        parts_.push_back({b, p, mirror, ball_around(*part.mesh), groups_of(*part.mesh)});
      }
    }
  }
}

std::vector<MirrorSurvey::Group> MirrorSurvey::groups_of(const TriangleMesh& mesh) {
  std::vector<Group> groups;
  for (std::size_t first = 0; first < mesh.triangle_count(); first += triangles_per_group) {
    groups.push_back(group_of(mesh, first, std::min(first + triangles_per_group, mesh.triangle_count())));
  }
  return groups;
}

MirrorSurvey::Group MirrorSurvey::group_of(const TriangleMesh& mesh, std::size_t first, std::size_t end) {
  const auto corner = [&](std::size_t triangle, std::size_t i) {
    return glm::dvec3(mesh.positions[mesh.indices[3 * triangle + i]]);
  };
  const auto normal = [&](std::size_t t) {
    return glm::normalize(glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
  };
  glm::dvec3 low(corner(first, 0)), high(low);
  for (std::size_t t = first; t < end; ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      low = glm::min(low, corner(t, i));
      high = glm::max(high, corner(t, i));
    }
  }
  Group group;
  group.centre_m = 0.5 * (low + high);
  group.radius_m = 0.5 * glm::length(high - low);
  // Both sides of a triangle mirror, so normals are turned to the side of the first triangle's normal.
  glm::dvec3 sum(0.0);
  for (std::size_t t = first; t < end; ++t) {
    const glm::dvec3 n = normal(t);
    sum += glm::dot(n, normal(first)) < 0 ? -n : n;
  }
  group.normal = glm::normalize(sum);
  double least_cosine = 1.0;
  for (std::size_t t = first; t < end; ++t) {
    least_cosine = std::min(least_cosine, std::abs(glm::dot(normal(t), group.normal)));
  }
  group.half_angle_rad = std::acos(std::min(1.0, least_cosine));
  return group;
}

std::vector<MirrorSurvey::Ball> MirrorSurvey::small_parts(const World& world,
                                                          const glm::dvec3& sonar_position_m, double range_m,
                                                          double angle_rad) const {
  std::vector<Ball> small;
  for (const Part& part : parts_) {
    if (world.is_terrain(part.body, part.part)) {
      continue;  // terrain tiles do not stand alone
    }
    const Body& body = world.bodies[part.body];
    const Pose T_world_part = body.T_world_body * body.parts[part.part].T_body_part;
    const glm::dvec3 centre_m = T_world_part * part.ball.centre_m - sonar_position_m;
    const double distance_m = glm::length(centre_m);
    if (distance_m < range_m && 2 * part.ball.radius_m < angle_rad * distance_m) {
      small.push_back({centre_m, part.ball.radius_m});
    }
  }
  return small;
}

bool MirrorSurvey::has_mirror(const World& world, const glm::dvec3& sonar_position_m, double range_m,
                              double wavelength_m) const {
  for (const Part& part : parts_) {
    const Body& body = world.bodies[part.body];
    const Pose T_part_world = inverse(body.T_world_body * body.parts[part.part].T_body_part);
    const glm::dvec3 sonar_m = T_part_world * sonar_position_m;
    for (const Group& group : part.groups) {
      const glm::dvec3 to_centre = group.centre_m - sonar_m;
      const double distance_m = glm::length(to_centre);
      if (distance_m - group.radius_m > range_m) {
        continue;
      }
      // With a facet's normal within `cone` of the axis, |n.x| >= |axis.x| cos(cone) - |x| sin(cone).
      // |axis.x| differs by at most the ball's radius from its value at the centre; for facets in one plane
      // it does not differ.
      const double cone = std::min(group.half_angle_rad, std::numbers::pi / 2);
      const double height_m = std::abs(glm::dot(to_centre, group.normal));
      const double least_height_m = height_m - (cone < one_plane_rad ? 0.0 : group.radius_m);
      const double farthest_m = std::min(range_m, distance_m + group.radius_m);
      const double sine = least_height_m * std::cos(cone) / farthest_m - std::sin(cone);
      const double sin_grazing = std::clamp(sine, 0.0, 1.0);
      if (part.mirror.gain(sin_grazing, wavelength_m) > least_mirror_gain) {
        return true;
      }
    }
  }
  return false;
}

bool water_surface_mirrors(const Mirror& surface, double depth_m, double range_m, double wavelength_m) {
  return depth_m > 0 && depth_m < range_m &&
         surface.gain(depth_m / range_m, wavelength_m) > least_mirror_gain;
}

}  // namespace sonard::render
