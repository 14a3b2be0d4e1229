// SPDX-License-Identifier: Apache-2.0
// Search trees of the world, to find the surfaces that rays hit.
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

/// The hit of a single ray.
struct SurfaceHit {
  float distance_m = 0.0F;
  glm::vec3 normal{0.0F};        ///< geometric, in world axes; any length, not flipped towards the ray
  std::uint32_t part = no_part;  ///< counts the parts of all bodies in the order of the world
  std::uint32_t triangle = 0;    ///< of the part's mesh
};

/// The present world, and Embree's trees of it: one per mesh and one over the parts. They are built in the
/// first call of place(), so a program that never traces never builds them.
///
/// Rays and normals are in world axes with the sonar at the origin. World positions are subtracted in double
/// precision, once per part and position of the sonar. Bounding boxes of upright objects stay tight for any
/// heading. Call place() and the functions that change the world from one thread, while no other thread
/// traces. Any number of threads may call const functions.
class SpatialIndex {
 public:
  /// @param workers must outlive the index.
  /// @param embree_settings for rtcNewDevice(), for tests: "isa=sse4.2".
  /// @throws RendererError if Embree cannot be set up.
  SpatialIndex(World world, WorkerPool& workers, const std::string& embree_settings = {});
  ~SpatialIndex();
  SpatialIndex(const SpatialIndex&) = delete;
  SpatialIndex& operator=(const SpatialIndex&) = delete;

  /// The world with the present poses of bodies and meshes of parts.
  const World& world() const;

  /// @param body index of the body in the world; the pose is in the world frame.
  void set_body_pose(std::size_t body, const Pose& T_world_body);

  /// Replaces the meshes of parts; attributes must stay the same.
  void set_part_meshes(std::span<const PartMesh> changes);

  /// Sets the sonar's position, and applies changed poses and meshes. Call it before any search; it costs
  /// nothing if nothing has changed since the last call.
  /// @throws RendererError if Embree fails or runs out of memory.
  void place(const glm::dvec3& sonar_position_m);

  /// Whether the trees are built.
  bool is_built() const;

  /// Axes of a part in the world, as of the last place().
  const std::array<glm::vec3, 3>& axes(std::size_t part) const;

  /// Finds the first surface along each ray from the sonar, between the depths nearest_depth_m and
  /// `max_depth`, in lengths of q.
  /// @param back_faces false: rays pass through triangles from behind.
  void trace(const RayPacket& rays, float max_depth, bool back_faces, RayHits& hits) const;

  /// Traces rays of unit length, with normals in world axes.
  /// @param hits part is no_part if the ray hits nothing
  void trace(const RayPacket& rays, float farthest_m, std::array<SurfaceHit, packet_size>& hits) const;

  /// Finds the first surface along one ray from any point, relative to the sonar.
  /// @param direction unit.
  /// @return false if there is no surface within `farthest_m`.
  bool trace_one(const glm::vec3& origin_m, const glm::vec3& direction, float farthest_m,
                 SurfaceHit& hit) const;

  /// Whether no surface lies between a point and `distance_m` along a unit direction.
  bool is_free(const glm::vec3& origin_m, const glm::vec3& direction, float distance_m) const;

  /// "Embree 3.13.5, packets of 16".
  const std::string& description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
