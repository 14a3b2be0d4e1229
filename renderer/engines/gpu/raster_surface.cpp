// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/raster_surface.hpp"

#include <cstddef>
#include <cstring>

#include <fmt/format.h>
#include <osg/Image>

#include "renderer/surface/backscatter.hpp"
#include "renderer/surface/normal_pyramid.hpp"

namespace sonard::render {

namespace {

constexpr int normal_map_unit = 0;
constexpr std::size_t row_texels = 4096;  // as in surface.frag

Shading shading_of(const BodyPart& part) {
  if (part.normal_map && part.mesh->can_be_mapped()) {
    return Shading::normal_mapped;
  }
  return part.mesh->normals.empty() ? Shading::geometric_normal : Shading::vertex_normals;
}

/// Adds the texels of all levels in one texture.
void add_normal_map(const NormalPyramid& pyramid, osg::StateSet& state) {
  const std::size_t rows = (pyramid.texels.size() + row_texels - 1) / row_texels;
  osg::ref_ptr<osg::Image> image = new osg::Image;
  image->allocateImage(row_texels, static_cast<int>(rows), 1, GL_RGBA_INTEGER_EXT, GL_SHORT);
  std::memcpy(image->data(), pyramid.texels.data(), pyramid.texels.size() * sizeof(NormalPyramid::Texel));
  osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D(image);
  texture->setInternalFormat(GL_RGBA16I_EXT);
  texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::NEAREST);
  texture->setFilter(osg::Texture::MAG_FILTER, osg::Texture::NEAREST);
  texture->setResizeNonPowerOfTwoHint(false);
  const auto level_count = static_cast<int>(pyramid.levels.size());
  osg::ref_ptr<osg::Uniform> levels = new osg::Uniform(osg::Uniform::INT_VEC3, "map_levels", level_count);
  for (unsigned i = 0; i < pyramid.levels.size(); ++i) {
    const auto& [width_px, height_px, first_texel] = pyramid.levels[i];
    levels->setElement(i, width_px, height_px, static_cast<int>(first_texel));
  }
  state.setTextureAttributeAndModes(normal_map_unit, texture);
  state.addUniform(new osg::Uniform("normal_map", normal_map_unit));
  state.addUniform(new osg::Uniform("map_level_count", level_count));
  state.addUniform(levels);
}

}  // namespace

RasterSurface make_raster_surface(const BodyPart& part) {
  RasterSurface surface{new osg::StateSet, shading_of(part)};
  osg::StateSet& state = *surface.state;
  if (surface.shading == Shading::normal_mapped) {
    add_normal_map(NormalPyramid(*part.normal_map), state);
  }
  const Backscatter backscatter(part.material);
  state.addUniform(new osg::Uniform("reflectance", static_cast<float>(part.material.reflectance)));
  state.addUniform(new osg::Uniform("lambert_mu", backscatter.lambert_mu));
  state.addUniform(new osg::Uniform("facet_strength", backscatter.facet_strength));
  state.addUniform(new osg::Uniform("slope_variance", backscatter.slope_variance));
  state.addUniform(new osg::Uniform("facets_least_cosine", backscatter.least_cosine));
  return surface;
}

bool same_surface(const BodyPart& a, const BodyPart& b) {
  return a.material == b.material && a.normal_map == b.normal_map && shading_of(a) == shading_of(b);
}

const osg::Texture2D* normal_map_of(const osg::StateSet& state) {
  return static_cast<const osg::Texture2D*>(
      state.getTextureAttribute(normal_map_unit, osg::StateAttribute::TEXTURE));
}

std::string surface_shader_head(Shading shading, const SurfaceModel& surface, bool bent) {
  // FACETS: 0 no facets, 1 near normal incidence, 2 everywhere.
  return fmt::format(
      "#version 430 compatibility\n#define SHADING {}\n#define FACETS {}\n#define PHYSICAL {:d}\n#define "
      "BENT {:d}\n",
      static_cast<int>(shading), static_cast<int>(surface.facets), surface.model == Model::physical, bent);
}

}  // namespace sonard::render
