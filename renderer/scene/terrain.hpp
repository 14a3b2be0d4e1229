// SPDX-License-Identifier: Apache-2.0
// A large heightmap in tiles, which become triangles at a requested level of detail.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/scene/image_file.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// At level l, a tile has a vertex every 2^l pixels, and at its rim. A side may have the coarser level of its
/// neighbour: tiles with the same level on a shared side leave no gap.
struct TileDetail {
  enum Side : std::size_t { west, east, south, north };
  int level = 0;
  std::array<int, 4> sides{};  ///< levels by Side, each >= `level`

  bool operator==(const TileDetail&) const = default;
};

/// Coordinates are as in make_heightfield() with the centre at the origin, in single precision. Several
/// threads may read it.
class Terrain {
 public:
  static constexpr int tile_px = 128;  ///< cells a side; fewer in the last tile of a row or column
  static constexpr int coarsest_level = 5;

  struct Tile {
    glm::vec3 low_m, high_m;
    /// By level: largest vertical distance of its surface, or of a finer level's, from level 0.
    std::array<float, coarsest_level + 1> error_m{};
    std::array<std::uint32_t, coarsest_level + 1> triangles{};
  };

  /// @param mapped meshes carry the attributes for a normal map.
  /// @throws WorldError as make_heightfield()
  Terrain(GreyImage picture, const glm::dvec3& size_m, bool mapped);

  int columns() const { return columns_; }  ///< of tiles, from west to east
  int rows() const { return rows_; }        ///< of tiles, from south to north
  /// Row by row from the south-west.
  const std::vector<Tile>& tiles() const { return tiles_; }

  TriangleMesh mesh(std::size_t tile, const TileDetail& detail) const;

 private:
  /// Pixels along one side of a tile that a level keeps.
  static std::vector<int> stops(int tile, int pixels, int level);
  double height_m(int x, int y) const;
  glm::vec3 position(int x, int y) const;
  glm::vec3 normal(int x, int y, int step_px) const;
  void measure(Tile& tile, int column, int row) const;
  double error_of_cell_m(int west, int east, int south, int north) const;

  GreyImage picture_;
  glm::dvec3 corner_m_;
  double step_x_m_, step_y_m_;
  double z_per_value_m_ = 0.0;
  bool mapped_;
  int columns_, rows_;
  std::vector<Tile> tiles_;
};

/// Adds a heightmap to a body that is or will be number `body` of the world: as one mesh, or as a terrain if
/// it has more than 2 x 2 tiles.
/// @param part all but its mesh; `T_body_part` is the pose of the middle of the map at the height of black.
/// @throws WorldError as make_heightfield()
void add_heightmap(GreyImage picture, const glm::dvec3& size_m, BodyPart part, World& world, std::size_t body,
                   std::vector<BodyPart>& parts);

}  // namespace sonard::render
