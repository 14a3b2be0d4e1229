// The world in Embree: packets of sixteen rays from the sonar go in, surfaces come out.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include <glm/vec3.hpp>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/visibility/ray_packet.hpp"
#include "renderer/visibility/sampler.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// What a single ray meets.
struct SurfaceHit {
  float distance_m = 0.0F;
  glm::vec3 normal{0.0F};        ///< geometric, in world axes, neither of unit length nor turned
  std::uint32_t part = no_part;  ///< counts the parts of all bodies in the order of the world
  std::uint32_t triangle = 0;    ///< of the part's mesh
};

/// Holds one acceleration structure per mesh and, above them, one over the parts. Rays and normals are in
/// world axes with the sonar at the origin: world positions are subtracted in double, once per part and
/// place, and the boxes of things that stand upright in the world stay tight however the sonar turns. place()
/// and set_body_pose() come from one thread while nobody traces; trace() may be called from any number of
/// threads.
class EmbreeScene {
 public:
  /// @param workers outlives the scene.
  /// @param embree_settings for rtcNewDevice(), for tests: "isa=sse4.2".
  /// @throws RendererError when Embree cannot be set up or runs out of memory.
  EmbreeScene(const World& world, WorkerPool& workers, const std::string& embree_settings = {});
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// @param body in the order of the world, and in it.
  void set_body_pose(std::size_t body, const Pose& T_world_body);

  /// From the next place() on, which builds them.
  void set_part_meshes(std::span<const PartMesh> changes);

  /// Puts the sonar here, and the bodies where they were last moved to. Costs nothing when neither changed.
  /// @throws RendererError when Embree fails.
  void place(const glm::dvec3& sonar_position_m);

  /// The first surface along each ray between the depths nearest_depth_m and `max_depth`, in lengths of q.
  void trace(const RayPacket& rays, const SurfaceModel& model, float max_depth,
             SurfacePacket& surfaces) const;

  /// The first surface along one ray from anywhere, relative to the sonar as all positions are.
  /// @param direction unit.
  /// @return false when there is none within `farthest_m`.
  bool trace_one(const glm::vec3& origin_m, const glm::vec3& direction, float farthest_m,
                 SurfaceHit& hit) const;

  /// The same for a packet of rays of unit length from the sonar.
  /// @param hits of a ray that meets nothing, the part is no_part
  void trace_plainly(const RayPacket& rays, float farthest_m,
                     std::array<SurfaceHit, packet_size>& hits) const;

  /// Whether nothing lies on the way from a point along a unit direction.
  bool is_free(const glm::vec3& origin_m, const glm::vec3& direction, float distance_m) const;

  /// "Embree 3.13.5, packets of 16".
  const std::string& description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
