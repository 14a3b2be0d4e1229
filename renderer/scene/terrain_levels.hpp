// SPDX-License-Identifier: Apache-2.0
// Chooses the detail of each terrain tile for a ping: as much as the sonar can resolve.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/scene/terrain.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// The values of a ping that set the detail of terrains.
struct TerrainView {
  glm::dvec3 sonar_position_m{0.0};
  double range_m = 0.0;  ///< farther tiles are not drawn
  double line_m = 0.0;
};

/// Caches the meshes of tiles. The choice depends only on the view, not on earlier views.
class TerrainLevels {
 public:
  /// @param longest_edge_m limit for all triangles if rays bend; 0: no limit.
  TerrainLevels(const World& world, const SkipSwitches& skip, float longest_edge_m);

  /// Whether the world has terrain; its meshes then depend on the ping.
  bool any() const { return !grounds_.empty(); }

  /// @param world the world of the constructor, with the present poses of its bodies.
  /// @return the changes since the last call. SkipRule::terrain_detail counts triangles.
  std::vector<PartMesh> refine(const TerrainView& view, const World& world, WorkerPool& workers,
                               SkipCounts& skipped);

 private:
  using Drawn = std::optional<TileDetail>;  ///< nullopt: not drawn
  struct Ground {
    std::shared_ptr<const Terrain> terrain;
    std::size_t body;
    std::size_t first_part;  ///< counted over all bodies
    Pose T_body_map;
    std::vector<Drawn> drawn;
    std::vector<float> distance_m;  ///< by tile, and its level; of this ping
    std::vector<int> level;
  };
  using MeshKey = std::tuple<std::size_t, std::size_t, int, std::array<int, 4>>;  ///< terrain, tile, detail
  /// Meshes made so far, as long as an engine keeps them.
  using Made = std::map<MeshKey, std::weak_ptr<const TriangleMesh>>;
  struct Change {
    std::size_t ground;
    std::size_t tile;
    std::shared_ptr<const TriangleMesh> mesh;
  };

  std::vector<Change> find_changes(double range_m);
  static void measure(Ground& ground, const TerrainView& view, const Pose& T_world_body);
  std::size_t choose(const TerrainView& view, double coarseness);
  static Drawn detail_of(const Ground& ground, std::size_t tile, double range_m);

  SkipSwitches skip_;
  float longest_edge_m_;
  std::vector<Ground> grounds_;
  Made made_;
  std::shared_ptr<const TriangleMesh> nothing_ = std::make_shared<const TriangleMesh>();
};

}  // namespace sonard::render
