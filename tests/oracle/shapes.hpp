// SPDX-License-Identifier: Apache-2.0
// Analytic surfaces, placed in the sonar frame. Metres.
#pragma once

#include <memory>
#include <vector>

#include "renderer/pose.hpp"
#include "tests/oracle/surface.hpp"

namespace sonard::oracle {

/// Infinite plane through `point` with unit normal `normal`.
std::unique_ptr<Surface> make_plane(const glm::dvec3& point, const glm::dvec3& normal,
                                    const Material& material);

/// Rectangle without thickness: centre plus or minus the half sides, which must be orthogonal.
std::unique_ptr<Surface> make_thin_wall(const glm::dvec3& centre, const glm::dvec3& half_side_u,
                                        const glm::dvec3& half_side_v, const Material& material);

std::unique_ptr<Surface> make_sphere(const glm::dvec3& centre, double radius, const Material& material);

/// Cylinder with caps, centred on the pose, along its z axis.
std::unique_ptr<Surface> make_cylinder(const render::Pose& T_sonar_shape, double radius, double length,
                                       const Material& material);

/// Box centred on the pose. From inside, its walls return the echo.
std::unique_ptr<Surface> make_box(const render::Pose& T_sonar_shape, const glm::dvec3& size,
                                  const Material& material);

/// The nearest surface of several.
std::unique_ptr<Surface> make_group(std::vector<std::unique_ptr<Surface>> members);

}  // namespace sonard::oracle
