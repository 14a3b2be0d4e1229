// SPDX-License-Identifier: Apache-2.0
#include "tests/scenes/bed.hpp"

namespace sonard::test {

render::TriangleMesh make_bed(const BedExtent& extent, int cells_x, int cells_y, BedHeight height) {
  render::TriangleMesh mesh;
  const auto columns = static_cast<std::size_t>(cells_x);
  const auto rows = static_cast<std::size_t>(cells_y);
  mesh.positions.reserve((columns + 1) * (rows + 1));
  mesh.indices.reserve(6 * columns * rows);
  for (int j = 0; j <= cells_y; ++j) {
    const double y = extent.south_m + (extent.north_m - extent.south_m) * j / cells_y;
    for (int i = 0; i <= cells_x; ++i) {
      const double x = extent.west_m + (extent.east_m - extent.west_m) * i / cells_x;
      mesh.positions.emplace_back(glm::dvec3(x, y, height(x, y)));
    }
  }
  for (std::size_t j = 0; j < rows; ++j) {
    for (std::size_t i = 0; i < columns; ++i) {
      const auto south_west = static_cast<std::uint32_t>(j * (columns + 1) + i);
      const auto north_west = static_cast<std::uint32_t>(south_west + columns + 1);
      mesh.indices.insert(mesh.indices.end(), {south_west, south_west + 1, north_west + 1, south_west,
                                               north_west + 1, north_west});
    }
  }
  return mesh;
}

}  // namespace sonard::test
