// SPDX-License-Identifier: Apache-2.0
// Which detail each tile of a terrain is drawn with in a ping: as much as the sonar can tell.
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

/// What a ping asks of terrains.
struct TerrainView {
  glm::dvec3 sonar_position_m{0.0};
  double range_m = 0.0;  ///< tiles beyond are not drawn
  double line_m = 0.0;
};

/// Keeps the mesh of every tile. The choice depends on the view alone, not on earlier ones.
class TerrainLevels {
 public:
  /// @param longest_edge_m of any triangle, where rays bend; 0: as they are.
  TerrainLevels(const World& world, const SkipSwitches& skip, float longest_edge_m);

  /// Whether the world has ground in levels: what is drawn of it then goes with the ping.
  bool any() const { return !grounds_.empty(); }

  /// @param world the one it was made of, with its bodies where they are now.
  /// @return what has changed since the last call. SkipRule::terrain_detail counts triangles.
  std::vector<PartMesh> refine(const TerrainView& view, const World& world, WorkerPool& workers,
                               SkipCounts& skipped);

 private:
  using Drawn = std::optional<TileDetail>;  ///< nullopt: not at all
  struct Ground {
    std::shared_ptr<const Terrain> terrain;
    std::size_t body;
    std::size_t first_part;  ///< counted through all bodies
    Pose T_body_map;
    std::vector<Drawn> drawn;
    std::vector<float> distance_m;  ///< of every tile, and its level; of this ping
    std::vector<int> level;
  };
  using MeshKey = std::tuple<std::size_t, std::size_t, int, std::array<int, 4>>;  ///< terrain, tile, detail
  /// Meshes made so far, as long as a sampler keeps them.
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
