// SPDX-License-Identifier: Apache-2.0
// Visibility by ray tracing on the CPU: one ray per pixel, sixteen at a time, on all cores.
#pragma once

#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "renderer/engines/cpu/ray_shading.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/spatial_index/spatial_index.hpp"
#include "renderer/surface/surface_model.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Samples a grid with Embree, without graphics. Pixels that no part of the grid uses stay at range 0.
class RaySampler {
 public:
  /// @param index moves the world; must outlive the sampler
  /// @param workers must outlive the sampler; a call needs it exclusively
  RaySampler(SpatialIndex& index, WorkerPool& workers);

  /// The samples of each view, row after row in the order of SubView; valid until the next call. Surfaces
  /// beyond `max_range_m` may be missing.
  /// @throws RendererError if Embree fails or runs out of memory
  std::vector<const SurfaceSample*> sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                           const SurfaceModel& surface, double max_range_m);
  /// See EchoEngine. With refraction the trees of the world are rebuilt for every ping, which costs several
  /// times as much as the ping.
  void set_refraction(double bend_per_m) { bend_per_m_ = bend_per_m; }

 private:
  /// Patch of packet_side x packet_side pixels, cut at the sides of the view.
  struct Tile {
    std::size_t view = 0;
    std::size_t column = 0, row = 0;  ///< counted in tiles
  };
  struct Rows {
    int begin = 0, end = 0;
    bool operator==(const Rows&) const = default;
  };
  /// A view with its rays in the order of a packet's lanes, single precision.
  struct View {
    SubView geometry;
    std::vector<Lanes<float>> tangent_x;  ///< by column of tiles
    std::vector<Lanes<float>> tangent_y;  ///< by row of tiles
    // In world axes, of the current ping: a ray is middle + tangent_y * up.
    glm::vec3 starboard{0.0F}, up{0.0F};  ///< what the tangents multiply
    std::vector<Lanes<float>> middle_x, middle_y,
        middle_z;  ///< by column of tiles: axis + tangent_x * starboard
    std::vector<SurfaceSample> samples;

    explicit View(const SubView& view);
    void turn(const glm::dquat& R_world_sonar);
  };

  void prepare(const SampleGrid& grid);
  void trace_tiles(const SpatialIndex& index, const SurfaceModel& surface, float max_range_m);
  void place_shaders(const SpatialIndex& index);
  void shade(const RayPacket& rays, const RayHits& hits, const SurfaceModel& surface,
             SurfacePacket& surfaces) const;
  void trace(const SpatialIndex& index, const Tile& tile, const SurfaceModel& surface, float max_range_m);
  static void store(const Lanes<SurfaceSample>& samples, const Tile& tile, View& view);

  SpatialIndex& index_;
  WorkerPool& workers_;
  std::vector<SurfaceShader> shaders_;  ///< of the parts of all bodies
  double bend_per_m_ = 0.0;
  std::vector<View> views_;
  std::vector<std::vector<Rows>> used_;  // per view and column of tiles: rows that parts of the grid use
  std::vector<Tile> tiles_;
};

}  // namespace sonard::render
