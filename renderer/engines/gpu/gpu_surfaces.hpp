// SPDX-License-Identifier: Apache-2.0
// The surfaces of a world on the GPU: materials, and what shades facets: vertex normals and normal maps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderer/engines/gpu/gpu_buffer.hpp"
#include "renderer/engines/gpu/records.hpp"
#include "renderer/engines/slices/part_surface.hpp"

namespace sonard::render {

/// Its context must be current when it is made, used and deleted.
class GpuSurfaces {
 public:
  explicit GpuSurfaces(osg::GLExtensions& gl) : world_(gl) {}

  /// Uploads the surfaces of the parts that a fan may see. Meshes and maps that parts share are uploaded
  /// once. Does nothing if they are the last ones.
  /// @param version changes with the surfaces
  /// @param may_be_seen of each part
  void hold(const std::vector<PartSurface>& surfaces, std::size_t version,
            const std::vector<bool>& may_be_seen);
  /// Uploads the surfaces for one ping. @param surfaces the same as of hold(), placed in the ping
  void upload(const std::vector<PartSurface>& surfaces, GpuBuffer& to) const;

  const GpuBuffer& world() const { return world_; }  ///< meshes and normal maps, as the shaders read them
  std::size_t bytes() const { return world_.bytes(); }
  bool any_shaded() const { return any_shaded_; }  ///< by vertex normals
  bool any_mapped() const { return any_mapped_; }
  bool any_facets() const { return any_facets_; }

 private:
  class Words;

  std::vector<records::Surface> records_;  ///< without rotations
  std::size_t version_ = 0;
  std::vector<bool> held_;
  GpuBuffer world_;
  bool any_shaded_ = false, any_mapped_ = false, any_facets_ = false;
};

}  // namespace sonard::render
