// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/normal_map_texture.hpp"

#include <cstddef>
#include <cstring>

#include <osg/GLObjects>
#include <osg/Image>

namespace sonard::render {

namespace {

constexpr std::size_t row_texels = 4096;

std::size_t rows_of(const NormalPyramid& pyramid) {
  return (pyramid.texels.size() + row_texels - 1) / row_texels;
}

}  // namespace

NormalMapTexture::NormalMapTexture(const NormalPyramid& pyramid)
    : Item(rows_of(pyramid) * row_texels * sizeof(NormalPyramid::Texel)) {
  osg::ref_ptr<osg::Image> image = new osg::Image;
  image->allocateImage(row_texels, static_cast<int>(rows_of(pyramid)), 1, GL_RGBA_INTEGER_EXT, GL_SHORT);
  std::memcpy(image->data(), pyramid.texels.data(), pyramid.texels.size() * sizeof(NormalPyramid::Texel));
  texture_ = new osg::Texture2D(image);
  texture_->setInternalFormat(GL_RGBA16I_EXT);
  texture_->setFilter(osg::Texture::MIN_FILTER, osg::Texture::NEAREST);
  texture_->setFilter(osg::Texture::MAG_FILTER, osg::Texture::NEAREST);
  texture_->setResizeNonPowerOfTwoHint(false);

  const auto level_count = static_cast<int>(pyramid.levels.size());
  levels_ = new osg::Uniform(osg::Uniform::INT_VEC3, "map_levels", level_count);
  for (int i = 0; i < level_count; ++i) {
    const NormalPyramid::Level& level = pyramid.levels[static_cast<std::size_t>(i)];
    levels_->setElement(static_cast<unsigned>(i), level.width_px, level.height_px,
                        static_cast<int>(level.first_texel));
  }
}

void NormalMapTexture::add_to(osg::StateSet& state) const {
  state.setTextureAttributeAndModes(normal_map_unit, texture_);
  state.addUniform(levels_);
  state.addUniform(new osg::Uniform("map_level_count", static_cast<int>(levels_->getNumElements())));
}

void NormalMapTexture::upload(osg::State& state) {
  texture_->apply(state);
  state.haveAppliedTextureAttribute(state.getActiveTextureUnit(), osg::StateAttribute::TEXTURE);
}

void NormalMapTexture::release(osg::State& state) {
  texture_->releaseGLObjects(&state);
  state.haveAppliedTextureAttribute(normal_map_unit, osg::StateAttribute::TEXTURE);
  osg::flushAllDeletedGLObjects(state.getContextID());  // else OpenSceneGraph keeps it for reuse
}

}  // namespace sonard::render
