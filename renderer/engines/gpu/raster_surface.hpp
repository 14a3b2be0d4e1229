// SPDX-License-Identifier: Apache-2.0
// Surfaces for RasterSampler: the input of the shaders surface.vert and surface.frag.
#pragma once

#include <string>

#include <osg/StateSet>
#include <osg/Texture2D>

#include "renderer/scene/world.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

/// Kind of a surface, which selects its program: the source of the normal for its echo.
enum class Shading { geometric_normal = 0, vertex_normals = 1, normal_mapped = 2 };

/// The surface of a part, or of several parts.
struct RasterSurface {
  osg::ref_ptr<osg::StateSet> state;  ///< uniforms of the material, normal map
  Shading shading = Shading::geometric_normal;
};

RasterSurface make_raster_surface(const BodyPart& part);
/// True if make_raster_surface() makes the same of both.
bool same_surface(const BodyPart& a, const BodyPart& b);
/// The normal map in the state of a surface; null: none.
const osg::Texture2D* normal_map_of(const osg::StateSet& state);

/// The beginning of both shaders. Each kind of surface has its own program with only the code for that kind,
/// because a software OpenGL runs both sides of every branch.
/// @param bent rays bend
std::string surface_shader_head(Shading shading, const SurfaceModel& surface, bool bent);

}  // namespace sonard::render
