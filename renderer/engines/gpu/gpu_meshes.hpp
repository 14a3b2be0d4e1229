// SPDX-License-Identifier: Apache-2.0
// The meshes of a world in video memory, for compute shaders.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "renderer/engines/gpu/gpu_buffer.hpp"
#include "renderer/engines/slices/mesh_clusters.hpp"

namespace sonard::render {

/// Holds the clusters of the meshes that pings need, each mesh once, within a bound. If there is no room for
/// another mesh, those that the ping does not need are dropped. The context must be current in every call.
class GpuMeshes {
 public:
  GpuMeshes(osg::GLExtensions& gl, std::uint64_t bound_bytes)
      : bound_bytes_(bound_bytes), vertices_(gl), triangles_(gl), clusters_(gl) {}

  /// Uploads what is missing of these meshes. Earlier pings in flight keep their data.
  /// @param beside_bytes of other things, which count too
  /// @throws RequestError if they exceed the bound; then nothing changes
  /// @throws RendererError if OpenGL has no room for them
  void hold(const std::vector<std::shared_ptr<const MeshClusters>>& meshes, std::uint64_t beside_bytes);

  /// Index of the first cluster of a mesh of the last hold().
  std::uint32_t first_cluster(const std::shared_ptr<const MeshClusters>& mesh) const {
    return held_.at(mesh);
  }
  const GpuBuffer& vertices() const { return vertices_; }
  const GpuBuffer& triangles() const { return triangles_; }
  const GpuBuffer& clusters() const { return clusters_; }

  std::uint64_t bytes() const { return vertices_.bytes() + triangles_.bytes() + clusters_.bytes(); }
  /// Sum since construction, including repeated uploads.
  std::uint64_t bytes_uploaded() const { return bytes_uploaded_; }

 private:
  /// Of records.
  struct Sizes {
    std::size_t vertices = 0, triangles = 0, clusters = 0;

    std::uint64_t bytes() const;
    bool within(const Sizes& room) const;
    Sizes operator+(const Sizes& more) const;
  };
  static Sizes sizes_of(const MeshClusters& mesh);

  void start_again(const Sizes& needed, std::uint64_t beside_bytes);
  /// @return index of its first cluster
  std::uint32_t upload(const MeshClusters& mesh);

  const std::uint64_t bound_bytes_;
  std::uint64_t bytes_uploaded_ = 0;
  GpuBuffer vertices_, triangles_, clusters_;
  Sizes room_, used_;
  std::map<std::shared_ptr<const MeshClusters>, std::uint32_t> held_;  ///< their first clusters
};

}  // namespace sonard::render
