// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/terrain_levels.hpp"

#include <algorithm>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "renderer/scene/tessellation.hpp"

namespace sonard::render {

namespace {

// Largest vertical error of a tile: range lines plus a share of the distance, which is a 27th of a beam of
// 0.47 degrees.
constexpr double error_lines = 0.03;
constexpr double error_rad = 3e-4;
constexpr std::size_t most_known_meshes = 20'000;
constexpr std::size_t most_triangles = 2'000'000;  // in range; else errors are doubled until there are fewer

}  // namespace

TerrainLevels::TerrainLevels(const World& world, const SkipSwitches& skip, float longest_edge_m)
    : skip_(skip), longest_edge_m_(longest_edge_m) {
  for (const TerrainParts& parts : world.terrains) {
    std::size_t first_part = parts.first_part;
    for (std::size_t body = 0; body < parts.body; ++body) {
      first_part += world.bodies[body].parts.size();
    }
    const std::size_t tiles = parts.terrain->tiles().size();
    const TileDetail coarsest{
        Terrain::coarsest_level,
        {Terrain::coarsest_level, Terrain::coarsest_level, Terrain::coarsest_level, Terrain::coarsest_level}};
    grounds_.push_back(
        {parts.terrain, parts.body, first_part, world.bodies[parts.body].parts[parts.first_part].T_body_part,
         std::vector<Drawn>(tiles, coarsest), std::vector<float>(tiles), std::vector<int>(tiles)});
  }
}

void TerrainLevels::measure(Ground& ground, const TerrainView& view, const Pose& T_world_body) {
  const Pose T_sonar_map = relative({view.sonar_position_m, {1, 0, 0, 0}}, T_world_body) * ground.T_body_map;
  const glm::vec3 sonar_m(inverse(T_sonar_map).position_m);
  const std::vector<Terrain::Tile>& tiles = ground.terrain->tiles();
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    ground.distance_m[i] = glm::distance(sonar_m, glm::clamp(sonar_m, tiles[i].low_m, tiles[i].high_m));
  }
}

/// Chooses levels for all tiles, including neighbours of the tiles in range. @return the triangles in range.
std::size_t TerrainLevels::choose(const TerrainView& view, double coarseness) {
  std::size_t triangles = 0;
  for (Ground& ground : grounds_) {
    for (std::size_t i = 0; i < ground.level.size(); ++i) {
      const Terrain::Tile& tile = ground.terrain->tiles()[i];
      const auto distance_m = static_cast<double>(ground.distance_m[i]);
      const auto allowed_m =
          static_cast<float>(coarseness * (error_lines * view.line_m + error_rad * distance_m));
      std::size_t level = 0;
      while (level < Terrain::coarsest_level && tile.error_m[level + 1] <= allowed_m) {
        ++level;
      }
      ground.level[i] = static_cast<int>(level);
      triangles += distance_m <= view.range_m ? tile.triangles[level] : 0;
    }
  }
  return triangles;
}

TerrainLevels::Drawn TerrainLevels::detail_of(const Ground& ground, std::size_t tile, double range_m) {
  if (static_cast<double>(ground.distance_m[tile]) > range_m) {
    return std::nullopt;
  }
  const auto columns = static_cast<std::size_t>(ground.terrain->columns());
  const int level = ground.level[tile];
  const auto shared = [&](bool has_neighbour, std::size_t neighbour) {
    return has_neighbour ? std::max(level, ground.level[neighbour]) : level;
  };
  return TileDetail{level,
                    {shared(tile % columns > 0, tile - 1), shared(tile % columns + 1 < columns, tile + 1),
                     shared(tile >= columns, tile - columns),
                     shared(tile + columns < ground.level.size(), tile + columns)}};
}

std::vector<PartMesh> TerrainLevels::refine(const TerrainView& view, const World& world, WorkerPool& workers,
                                            SkipCounts& skipped) {
  for (Ground& ground : grounds_) {
    measure(ground, view, world.bodies[ground.body].T_world_body);
  }
  const bool may_skip = skip_.on(SkipRule::terrain_detail);
  const std::size_t finest = choose(view, 0.0);
  if (may_skip) {
    double coarseness = 1.0;
    std::size_t triangles = choose(view, coarseness);
    for (constexpr double most = 0x1p20; triangles > most_triangles && coarseness < most;) {
      triangles = choose(view, coarseness *= 2);
    }
    skipped.add(SkipRule::terrain_detail, finest - triangles);
  }
  std::vector<Change> changes = find_changes(view.range_m);
  workers.run(static_cast<int>(changes.size()), [&](int i) {
    Change& change = changes[static_cast<std::size_t>(i)];
    if (!change.mesh) {
      const Ground& ground = grounds_[change.ground];
      TriangleMesh mesh = ground.terrain->mesh(change.tile, *ground.drawn[change.tile]);
      change.mesh = std::make_shared<const TriangleMesh>(
          longest_edge_m_ > 0 ? tessellated(mesh, longest_edge_m_) : std::move(mesh));
    }
  });
  std::vector<PartMesh> meshes;
  for (const Change& change : changes) {
    const Ground& ground = grounds_[change.ground];
    if (const Drawn& detail = ground.drawn[change.tile]) {
      made_[{change.ground, change.tile, detail->level, detail->sides}] = change.mesh;
    }
    meshes.push_back({ground.first_part + change.tile, change.mesh});
  }
  return meshes;
}

/// Stores the new detail of each tile. Meshes that are not cached stay null, to be made later.
std::vector<TerrainLevels::Change> TerrainLevels::find_changes(double range_m) {
  if (made_.size() > most_known_meshes) {
    std::erase_if(made_, [](const auto& entry) { return entry.second.expired(); });
  }
  std::vector<Change> changes;
  for (std::size_t g = 0; g < grounds_.size(); ++g) {
    Ground& ground = grounds_[g];
    for (std::size_t tile = 0; tile < ground.drawn.size(); ++tile) {
      const Drawn detail = detail_of(ground, tile, range_m);
      if (detail == ground.drawn[tile]) {
        continue;
      }
      ground.drawn[tile] = detail;
      changes.push_back({g, tile, nothing_});
      if (detail) {
        const auto known = made_.find({g, tile, detail->level, detail->sides});
        changes.back().mesh = known != made_.end() ? known->second.lock() : nullptr;
      }
    }
  }
  return changes;
}

}  // namespace sonard::render
