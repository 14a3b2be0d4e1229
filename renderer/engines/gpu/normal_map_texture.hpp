// SPDX-License-Identifier: Apache-2.0
// A normal map for surface_shader.hpp: the texels of all levels in one texture.
#pragma once

#include <osg/StateSet>
#include <osg/Texture2D>

#include "renderer/engines/gpu/video_memory.hpp"
#include "renderer/surface/normal_pyramid.hpp"

namespace sonard::render {

/// Texture unit of normal maps.
inline constexpr int normal_map_unit = 0;

class NormalMapTexture final : public VideoMemory::Item {
 public:
  explicit NormalMapTexture(const NormalPyramid& pyramid);
  ~NormalMapTexture() override { remove(); }

  /// Adds the map to a state, so that drawables with this state use it.
  void add_to(osg::StateSet& state) const;

 private:
  void upload(osg::State& state) override;
  void release(osg::State& state) override;

  osg::ref_ptr<osg::Texture2D> texture_;
  osg::ref_ptr<osg::Uniform> levels_;  ///< places of the levels in the texture
};

}  // namespace sonard::render
