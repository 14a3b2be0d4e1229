// SPDX-License-Identifier: Apache-2.0
#include "server/yaml/pose_section.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>

namespace sonard::server {
namespace {

/// Whether an angle looks like a multiple of 5 degrees (at least 10) in radians, written with two or more
/// decimals. Angles with one decimal (0.5, 1.4) are more likely to be degrees.
bool looks_like_radians(double angle) {
  constexpr double step = std::numbers::pi / 36;
  const double multiple = std::round(angle / step);
  const double off = std::abs(angle - multiple * step);
  const auto has_digits = [&](double scale) {
    return std::abs(scale * angle - std::round(scale * angle)) < 1e-9;
  };
  return multiple >= 2.0 && !has_digits(10.0) && off < (has_digits(100.0) ? 0.005 : 0.0006);
}

/// Whether three angles are likely to be radians instead of degrees: none exceeds one turn.
bool look_like_radians(const glm::dvec3& angles) {
  bool any = false;
  for (int axis = 0; axis < 3; ++axis) {
    const double angle = std::abs(angles[axis]);
    if (angle > 2.001 * std::numbers::pi) {
      return false;
    }
    any = any || looks_like_radians(angle);
  }
  return any;
}

}  // namespace

void read_pose(YamlSection& section, render::Pose& pose, std::string_view position_meaning,
               std::string_view rpy_meaning) {
  constexpr double far_m = 1e8;  // larger than the Earth's radius: geocentric coordinates fit
  section.vector3("position_m", pose.position_m, Range::from(-far_m, far_m), position_meaning);
  for (const std::string_view key : {"roll", "pitch", "yaw", "roll_deg", "pitch_deg", "yaw_deg", "rpy"}) {
    section.foreign(key, "expected rpy_deg: [roll, pitch, yaw], in degrees");
  }
  for (const std::string_view key : {"x", "y", "z", "position", "xyz"}) {
    section.foreign(key, "expected position_m: [x, y, z], in metres");
  }
  glm::dvec3 rpy_deg{0.0};
  section.vector3("rpy_deg", rpy_deg, Range::from(-360.0, 360.0), rpy_meaning);
  if (look_like_radians(rpy_deg)) {
    section.warn("rpy_deg", fmt::format("{:.4g}, {:.4g}, {:.4g} look like radians (sonard expects degrees; "
                                        "{:.4g}, {:.4g}, {:.4g} degrees are the same rotation)",
                                        rpy_deg.x, rpy_deg.y, rpy_deg.z, glm::degrees(rpy_deg.x),
                                        glm::degrees(rpy_deg.y), glm::degrees(rpy_deg.z)));
  }
  const glm::dvec3 rpy = rpy_deg * (std::numbers::pi / 180.0);
  pose.orientation =
      glm::normalize(glm::angleAxis(rpy.z, glm::dvec3(0, 0, 1)) * glm::angleAxis(rpy.y, glm::dvec3(0, 1, 0)) *
                     glm::angleAxis(rpy.x, glm::dvec3(1, 0, 0)));
}

}  // namespace sonard::server
