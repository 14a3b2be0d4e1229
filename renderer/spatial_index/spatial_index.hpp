// SPDX-License-Identifier: Apache-2.0
// The world in search trees, to find what a ray meets.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include <glm/vec3.hpp>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/spatial_index/ray_packet.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// What a single ray meets.
struct SurfaceHit {
  float distance_m = 0.0F;
  glm::vec3 normal{0.0F};        ///< geometric, in world axes, neither of unit length nor turned
  std::uint32_t part = no_part;  ///< counts the parts of all bodies in the order of the world
  std::uint32_t triangle = 0;    ///< of the part's mesh
};

/// The world as it is now, and over it Embree's trees: one per mesh and, above them, one over the parts. They
/// are built when place() is called for the first time, so that a program that never traces never builds
/// them.
///
/// Rays and normals are in world axes with the sonar at the origin: world positions are subtracted in double,
/// once per part and place, and the boxes of things that stand upright in the world stay tight however the
/// sonar turns. place() and what changes the world come from one thread while no other traces; all that is
/// const may be called from any number of threads.
class SpatialIndex {
 public:
  /// @param workers outlives the index.
  /// @param embree_settings for rtcNewDevice(), for tests: "isa=sse4.2".
  /// @throws RendererError when Embree cannot be set up.
  SpatialIndex(World world, WorkerPool& workers, const std::string& embree_settings = {});
  ~SpatialIndex();
  SpatialIndex(const SpatialIndex&) = delete;
  SpatialIndex& operator=(const SpatialIndex&) = delete;

  /// Bodies are where they were last moved to, and parts have the meshes they were last given.
  const World& world() const;

  /// @param body in the order of the world, and in it.
  void set_body_pose(std::size_t body, const Pose& T_world_body);

  /// Gives parts other meshes, with the attributes of those they had.
  void set_part_meshes(std::span<const PartMesh> changes);

  /// Puts the sonar here, and bodies and meshes where and what they are now. Has to come before any search;
  /// costs nothing when nothing has changed since the last call.
  /// @throws RendererError when Embree fails or runs out of memory.
  void place(const glm::dvec3& sonar_position_m);

  /// Whether there are trees.
  bool is_built() const;

  /// Axes of a part in the world, as of the last place().
  const std::array<glm::vec3, 3>& axes(std::size_t part) const;

  /// The first surface along each ray from the sonar between the depths nearest_depth_m and `max_depth`, in
  /// lengths of q.
  /// @param back_faces false: rays pass through triangles that they meet from behind.
  void trace(const RayPacket& rays, float max_depth, bool back_faces, RayHits& hits) const;

  /// Traces rays of unit length, with normals in world axes.
  /// @param hits of a ray that meets nothing, the part is no_part
  void trace(const RayPacket& rays, float farthest_m, std::array<SurfaceHit, packet_size>& hits) const;

  /// The first surface along one ray from anywhere, relative to the sonar as all positions are.
  /// @param direction unit.
  /// @return false when there is none within `farthest_m`.
  bool trace_one(const glm::vec3& origin_m, const glm::vec3& direction, float farthest_m,
                 SurfaceHit& hit) const;

  /// Whether nothing lies on the way from a point along a unit direction.
  bool is_free(const glm::vec3& origin_m, const glm::vec3& direction, float distance_m) const;

  /// "Embree 3.13.5, packets of 16".
  const std::string& description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
