// SPDX-License-Identifier: Apache-2.0
#include "server/diagnosis/view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>

#include "server/diagnosis/triangles.hpp"

namespace sonard::server {
namespace {

constexpr double half_turn_deg = 180.0;
constexpr double told_deg = 0.5;  // smaller angles are rounded away
constexpr double least_up = 0.5;  // of a bed's normal: slopes of up to 60 degrees

/// "forward", "30 degrees to port".
std::string bearing_words(double to_port_deg) {
  const double off_deg = std::abs(to_port_deg);
  const char* const side = to_port_deg > 0 ? "port" : "starboard";
  if (off_deg < told_deg) {
    return "forward";
  }
  if (off_deg > half_turn_deg - told_deg) {
    return "aft";
  }
  return std::abs(off_deg - 90.0) < told_deg ? fmt::format("to {}", side)
                                             : fmt::format("{:.0f} degrees to {}", off_deg, side);
}

/// A wedge between two directions less than 180 degrees apart, in a plane.
struct Wedge {
  glm::dvec2 low, high;  ///< high is counter-clockwise of low

  double above_low(const glm::dvec2& p) const { return low.x * p.y - low.y * p.x; }
  double below_high(const glm::dvec2& p) const { return high.y * p.x - high.x * p.y; }
};

/// Cuts off the part of a segment that has a negative `side`. Returns false if nothing is left.
template <class Side>
bool cut(glm::dvec2& a, glm::dvec2& b, Side side) {
  const double at_a = side(a);
  const double at_b = side(b);
  if (at_a < 0 && at_b < 0) {
    return false;
  }
  if (at_a < 0 || at_b < 0) {
    const glm::dvec2 crossing = a + at_a / (at_a - at_b) * (b - a);
    (at_a < 0 ? a : b) = crossing;
  }
  return true;
}

double nearest_to_origin(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 along = b - a;
  const double length2 = glm::dot(along, along);
  const double share = length2 > 0 ? std::clamp(-glm::dot(a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::length(a + share * along);
}

/// The more upright of two planes through the acoustic axis, and the beam in it. It also serves a fan on its
/// side.
class BeamPlane {
 public:
  BeamPlane(const render::Pose& T_world_sonar, const render::Aperture& aperture) {
    const glm::dvec3 up = T_world_sonar.orientation * glm::dvec3(0, 0, 1);
    const glm::dvec3 port = T_world_sonar.orientation * glm::dvec3(0, 1, 0);
    is_upright_ = std::abs(up.z) >= std::abs(port.z);
    const std::vector<double>& edges = aperture.beam_edges_rad;  // to port
    const double half_rad = 0.5 * aperture.vertical_beamwidth_rad;
    const double from_rad = is_upright_ || edges.empty() ? -half_rad : std::min(edges.front(), edges.back());
    const double to_rad = is_upright_ || edges.empty() ? half_rad : std::max(edges.front(), edges.back());
    constexpr double widest_rad = 0.49 * std::numbers::pi;
    const double low_rad = std::max(from_rad, -widest_rad);
    const double high_rad = std::min(to_rad, widest_rad);
    wedge_ = {{std::cos(low_rad), std::sin(low_rad)}, {std::cos(high_rad), std::sin(high_rad)}};
  }

  /// Updates the view with the part of a triangle that is in the plane and the beam; corners in the sonar's
  /// frame.
  void look_at(const std::array<glm::dvec3, 3>& corners, BedView& view, double range_m) const {
    std::array<glm::dvec2, 3> cuts;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3 && count < 2; ++i) {
      const glm::dvec3& a = corners[i];
      const glm::dvec3& b = corners[(i + 1) % 3];
      if ((off(a) < 0) != (off(b) < 0)) {
        const glm::dvec3 p = a + off(a) / (off(a) - off(b)) * (b - a);
        cuts[count++] = {p.x, is_upright_ ? p.z : p.y};
      }
    }
    if (count < 2 || !cut(cuts[0], cuts[1], [&](const glm::dvec2& p) { return wedge_.above_low(p); }) ||
        !cut(cuts[0], cuts[1], [&](const glm::dvec2& p) { return wedge_.below_high(p); })) {
      return;
    }
    const double nearest_m = nearest_to_origin(cuts[0], cuts[1]);
    if (nearest_m > range_m) {
      return;
    }
    const double farthest_m = std::min(range_m, std::max(glm::length(cuts[0]), glm::length(cuts[1])));
    view.nearest_m = std::min(nearest_m, view.nearest_m.value_or(nearest_m));
    view.farthest_m = std::max(farthest_m, view.farthest_m.value_or(farthest_m));
  }

 private:
  double off(const glm::dvec3& p) const { return is_upright_ ? p.y : p.z; }

  bool is_upright_ = true;
  Wedge wedge_{};
};

/// Depth of a triangle straight below the origin, in metres; infinite if it is not below. Corners in world
/// axes.
double depth_below(const std::array<glm::dvec3, 3>& corners) {
  const auto edge = [](const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.y - a.y * b.x; };
  const std::array<double, 3> weights{edge(corners[1], corners[2]), edge(corners[2], corners[0]),
                                      edge(corners[0], corners[1])};
  const double area = weights[0] + weights[1] + weights[2];
  const bool within = std::ranges::all_of(weights, [](double w) { return w >= 0; }) ||
                      std::ranges::all_of(weights, [](double w) { return w <= 0; });
  if (area == 0.0 || !within) {
    return std::numeric_limits<double>::infinity();
  }
  const double z = (weights[0] * corners[0].z + weights[1] * corners[1].z + weights[2] * corners[2].z) / area;
  return z < 0 ? -z : std::numeric_limits<double>::infinity();
}

/// Transforms the corners of a body's triangle.
std::array<glm::dvec3, 3> seen(const std::array<glm::dvec3, 3>& corners, const render::Pose& T_axes_body) {
  return {T_axes_body * corners[0], T_axes_body * corners[1], T_axes_body * corners[2]};
}

}  // namespace

std::string looks_text(const render::Pose& T_vehicle_sonar) {
  const glm::dvec3 axis = T_vehicle_sonar.orientation * glm::dvec3(1, 0, 0);
  const double down_deg = -glm::degrees(std::asin(std::clamp(axis.z, -1.0, 1.0)));
  std::string text;
  if (std::abs(down_deg) > 90.0 - told_deg) {
    return down_deg > 0 ? "straight down" : "straight up";
  }
  text = bearing_words(glm::degrees(std::atan2(axis.y, axis.x)));
  if (std::abs(down_deg) >= told_deg) {
    text += fmt::format(" and {:.0f} degrees {}", std::abs(down_deg), down_deg > 0 ? "down" : "up");
  }
  const glm::dvec3 port = T_vehicle_sonar.orientation * glm::dvec3(0, 1, 0);
  const glm::dvec3 up = T_vehicle_sonar.orientation * glm::dvec3(0, 0, 1);
  const double roll_deg = std::abs(glm::degrees(std::atan2(port.z, up.z)));
  if (roll_deg > half_turn_deg - told_deg) {
    text += ", upside down";
  } else if (roll_deg >= told_deg) {
    text += fmt::format(", rolled by {:.0f} degrees", roll_deg);
  }
  return text;
}

std::optional<BedView> view_of_bed(const render::World& world, const std::vector<PosedBody>& moved,
                                   const std::string& without, const render::Pose& T_world_sonar,
                                   const render::Aperture& aperture, double range_m) {
  const auto pose_of = [&](const render::Body& body) {
    const auto found = std::ranges::find(moved, body.name, &PosedBody::name);
    return found != moved.end() ? found->T_world_body : body.T_world_body;
  };
  const render::Body* bed = nullptr;
  double below_m = std::numeric_limits<double>::infinity();
  for (const render::Body& body : world.bodies) {
    if (body.name == without) {
      continue;
    }
    render::Pose T_level_body = pose_of(body);
    T_level_body.position_m -= T_world_sonar.position_m;
    each_triangle(body, [&](const std::array<glm::dvec3, 3>& corners) {
      if (const double depth_m = depth_below(seen(corners, T_level_body)); depth_m < below_m) {
        below_m = depth_m;
        bed = &body;
      }
    });
  }
  if (bed == nullptr) {
    return std::nullopt;
  }
  BedView view{bed->name, below_m, {}, {}};
  const BeamPlane plane(T_world_sonar, aperture);
  const glm::dvec3 up = glm::conjugate(T_world_sonar.orientation) * glm::dvec3(0, 0, 1);
  const render::Pose T_sonar_body = render::inverse(T_world_sonar) * pose_of(*bed);
  each_triangle(*bed, [&](const std::array<glm::dvec3, 3>& corners) {
    const auto from_sonar = seen(corners, T_sonar_body);
    const glm::dvec3 normal = glm::cross(from_sonar[1] - from_sonar[0], from_sonar[2] - from_sonar[0]);
    // Skips undersides of slabs, and walls that belong to the floor's body.
    if (glm::dot(normal, from_sonar[0]) < 0 && glm::dot(normal, up) > least_up * glm::length(normal)) {
      plane.look_at(from_sonar, view, range_m);
    }
  });
  return view;
}

std::string bed_text(const std::optional<BedView>& view, double range_m) {
  if (!view) {
    return "nothing is below it";
  }
  if (!view->nearest_m) {
    return fmt::format("the bed below ('{}', {:.3g} m down) is outside the beam (-3 dB) within {:.4g} m",
                       view->body, view->below_m, range_m);
  }
  return fmt::format("the bed below ('{}') is visible from {:.3g} to {:.3g} m", view->body, *view->nearest_m,
                     *view->farthest_m);
}

}  // namespace sonard::server
