// SPDX-License-Identifier: Apache-2.0
// The shapes of SDF as triangles, centred on the origin as in SDF. Normals point outward and are smooth on
// curved parts; texture coordinates run over [0, 1]. Vertices lie on the true surface. Curved surfaces have
// at least 48 segments around; up to a radius of about 50 m, no triangle is farther than 2 mm from the true
// surface. All lengths in metres.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Segments around a circle of this radius, > 0 and finite: radius (1 - cos(pi / n)) is below the sagitta. A
/// multiple of 4, so that vertices lie on the axes.
int segments_around(double radius_m);

/// The shape has no surface, because sizes are 0.
struct ShapeOfNothing : WorldError {
  using WorldError::WorldError;
};

// Every function below throws WorldError if a size is not finite or below 0, and ShapeOfNothing if no surface
// is left. A box with one side of 0 is a plate, a cylinder or cone of length 0 a disc, a capsule of length 0
// a sphere.

TriangleMesh make_box(const glm::dvec3& size_m);
TriangleMesh make_sphere(double radius_m);
TriangleMesh make_ellipsoid(const glm::dvec3& radii_m);
/// Axis z, with caps.
TriangleMesh make_cylinder(double radius_m, double length_m);
/// Axis z, tip up, with a cap; the origin is at half the height.
TriangleMesh make_cone(double radius_m, double length_m);
/// Axis z; `length_m` is the length of the cylindrical part, as in SDF.
TriangleMesh make_capsule(double radius_m, double length_m);
/// A rectangle through the origin, visible from the side to which `normal` points (any length above 0). The
/// sides turn with the normal by the shortest way from z.
TriangleMesh make_plane(const glm::dvec2& size_m, const glm::dvec3& normal);

}  // namespace sonard::render
