// SPDX-License-Identifier: Apache-2.0
// A mesh in small clusters of neighbouring triangles; parts outside the fan are culled cluster by cluster.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "renderer/engines/slices/fan.hpp"
#include "renderer/engines/slices/shells.hpp"
#include "renderer/engines/slices/slice_math.hpp"
#include "renderer/scene/refraction.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Triangles of one mesh in the order of a space-filling curve. Every cluster has its own copy of its
/// vertices, so that only needed vertices are transformed, and an index fits in one byte.
struct MeshClusters {
  struct Cluster {
    glm::vec3 centre_m{0.0F};  ///< of its bounding sphere, in the frame of the part
    float radius_m = 0.0F;
    std::uint32_t first_vertex = 0;
    std::uint32_t vertex_count = 0;  ///< <= most_vertices
    std::uint32_t first_triangle = 0;
    std::uint32_t triangle_count = 0;
  };
  static constexpr std::size_t most_vertices = 128;
  static constexpr std::size_t most_triangles = 96;

  std::vector<Cluster> clusters;
  glm::vec3 centre_m{0.0F};  ///< of a sphere around all clusters, in the frame of the part
  float radius_m = 0.0F;
  std::vector<float> x, y, z;                        ///< vertices, cluster after cluster
  std::array<std::vector<std::uint8_t>, 3> corners;  ///< of each triangle, within its cluster's vertices
  std::vector<std::uint32_t> mesh_triangle;          ///< its number in the mesh
  Shells shells;
  std::vector<std::uint32_t> shell;  ///< of each triangle, Shells::none if both of its sides may be seen

  /// @param find_shells false: no triangle is of a shell
  MeshClusters(const TriangleMesh& mesh, bool find_shells);

 private:
  void add_cluster(const TriangleMesh& mesh, const std::vector<std::uint32_t>& order, std::size_t& next,
                   std::vector<std::int32_t>& local_of_vertex);
  void close_cluster(Cluster& cluster) const;
  void find_sphere();
};

/// The pose of one part of a body in this ping: p_sonar = rotation * p_part + translation, computed in
/// doubles.
struct PlacedPart {
  std::shared_ptr<const MeshClusters> clusters;
  glm::mat3 R_sonar_part{1.0F};
  glm::vec3 t_sonar_part_m{0.0F};

  /// False if the fan may see the part.
  bool misses(const Fan& fan, const Refraction& bend) const;
  slices::Placement placement() const;
  /// Appends Shell::outwards of each shell whose inner side is hidden from the sonar; 0 if it may be seen.
  /// @param may_hide false: no shell hides its inner side
  void append_hiding(bool may_hide, std::vector<float>& outwards) const;
};

}  // namespace sonard::render
