// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/terrain.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "renderer/scene/heightfield.hpp"
#include "renderer/scene/mesh.hpp"

namespace sonard::render {

namespace {

int tiles_along(int pixels) {
  return (pixels - 2) / Terrain::tile_px + 1;
}

}  // namespace

Terrain::Terrain(GreyImage picture, const glm::dvec3& size_m, bool mapped)
    : picture_(std::move(picture)),
      corner_m_(-0.5 * size_m.x, -0.5 * size_m.y, 0.0),
      step_x_m_(size_m.x / (picture_.width_px - 1)),
      step_y_m_(size_m.y / (picture_.height_px - 1)),
      mapped_(mapped),
      columns_(tiles_along(picture_.width_px)),
      rows_(tiles_along(picture_.height_px)) {
  check_heightfield(picture_, size_m, {});
  const std::uint16_t brightest = *std::max_element(picture_.value.begin(), picture_.value.end());
  z_per_value_m_ = brightest > 0 ? size_m.z / brightest : 0.0;
  tiles_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  auto tile = tiles_.begin();
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      measure(*tile++, column, row);
    }
  }
}

double Terrain::height_m(int x, int y) const {
  return picture_.value[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width_px) +
                        static_cast<std::size_t>(x)] *
         z_per_value_m_;
}

glm::vec3 Terrain::position(int x, int y) const {
  const glm::vec3 p(corner_m_ + glm::dvec3(x * step_x_m_, y * step_y_m_, height_m(x, y)));
  return p;
}

/// The normal of the mean slope over `step_px` to either side (one side at the rim of the map), so that
/// detail left out by a coarse level does not turn it.
glm::vec3 Terrain::normal(int x, int y, int step_px) const {
  int west = std::max(x - step_px, 0), east = std::min(x + step_px, picture_.width_px - 1);
  int south = std::max(y - step_px, 0), north = std::min(y + step_px, picture_.height_px - 1);
  west = picture_.is_hole(west, y) ? x : west;
  east = picture_.is_hole(east, y) ? x : east;
  south = picture_.is_hole(x, south) ? y : south;
  north = picture_.is_hole(x, north) ? y : north;
  const double rise_x = (height_m(west, y) - height_m(east, y)) / (std::max(1, east - west) * step_x_m_);
  const double rise_y = (height_m(x, south) - height_m(x, north)) / (std::max(1, north - south) * step_y_m_);
  const glm::vec3 n(glm::normalize(glm::dvec3(rise_x, rise_y, 1.0)));
  return n;
}

std::vector<int> Terrain::stops(int tile, int pixels, int level) {
  std::vector<int> kept;
  const int end = std::min((tile + 1) * tile_px, pixels - 1);
  for (int at = tile * tile_px; at < end; at += 1 << level) {
    kept.push_back(at);
  }
  kept.push_back(end);
  return kept;
}

/// Largest vertical distance between the pixels and the two triangles over them. Triangles of finer levels
/// lie within the coarser ones, so it is largest at a pixel. A hole makes it so large that a coarser level is
/// never chosen.
double Terrain::error_of_cell_m(int west, int east, int south, int north) const {
  const double a = height_m(west, south), b = height_m(east, south);
  const double c = height_m(west, north), d = height_m(east, north);
  double error_m = 0.0;
  for (int y = south; y <= north; ++y) {
    const double v = static_cast<double>(y - south) / (north - south);
    for (int x = west; x <= east; ++x) {
      if (picture_.is_hole(x, y)) {
        return 1e9;
      }
      const double u = static_cast<double>(x - west) / (east - west);
      const double facet_m = u > v ? a + u * (b - a) + v * (d - b) : a + v * (c - a) + u * (d - c);
      error_m = std::max(error_m, std::abs(height_m(x, y) - facet_m));
    }
  }
  return error_m;
}

void Terrain::measure(Tile& tile, int column, int row) const {
  for (int level = 0; level <= coarsest_level; ++level) {
    const auto l = static_cast<std::size_t>(level);
    const std::vector<int> xs = stops(column, picture_.width_px, level);
    const std::vector<int> ys = stops(row, picture_.height_px, level);
    tile.triangles[l] = static_cast<std::uint32_t>(2 * (xs.size() - 1) * (ys.size() - 1));
    for (std::size_t j = 0; level > 0 && j + 1 < ys.size(); ++j) {
      for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
        tile.error_m[l] = std::max(tile.error_m[l],
                                   static_cast<float>(error_of_cell_m(xs[i], xs[i + 1], ys[j], ys[j + 1])));
      }
    }
    if (level > 0) {  // a level never counts as more accurate than a finer one
      tile.error_m[l] = std::max(tile.error_m[l], tile.error_m[l - 1]);
      continue;
    }
    tile.low_m = position(xs.front(), ys.front());
    tile.high_m = position(xs.back(), ys.back());
    for (const int y : ys) {
      for (const int x : xs) {
        tile.low_m.z = std::min(tile.low_m.z, position(x, y).z);
        tile.high_m.z = std::max(tile.high_m.z, position(x, y).z);
      }
    }
  }
}

TriangleMesh Terrain::mesh(std::size_t tile, const TileDetail& detail) const {
  const auto columns = static_cast<std::size_t>(columns_);
  const std::vector<int> xs = stops(static_cast<int>(tile % columns), picture_.width_px, detail.level);
  const std::vector<int> ys = stops(static_cast<int>(tile / columns), picture_.height_px, detail.level);
  TriangleMesh mesh;
  for (const int y : ys) {
    for (const int x : xs) {
      mesh.positions.push_back(position(x, y));
      mesh.normals.push_back(normal(x, y, std::max(1, (1 << detail.level) / 2)));
      if (mapped_) {
        const glm::vec3 n = mesh.normals.back();
        mesh.texcoords.emplace_back(static_cast<double>(x) / (picture_.width_px - 1),
                                    static_cast<double>(y) / (picture_.height_px - 1));
        mesh.tangents.emplace_back(glm::normalize(glm::vec3(1, 0, 0) - n * n.x), 1.0F);
      }
    }
  }
  // A vertex that a side leaves out moves back to the last one that it keeps. Triangles without area are
  // dropped.
  const auto kept = [&](std::size_t i, std::size_t last, TileDetail::Side side) {
    const std::size_t every = std::size_t{1} << (detail.sides[side] - detail.level);
    return i == last ? i : i - i % every;
  };
  const std::size_t last_x = xs.size() - 1, last_y = ys.size() - 1;
  const auto vertex = [&](std::size_t i, std::size_t j) {
    const std::size_t x = j == 0        ? kept(i, last_x, TileDetail::south)
                          : j == last_y ? kept(i, last_x, TileDetail::north)
                                        : i;
    const std::size_t y = i == 0        ? kept(j, last_y, TileDetail::west)
                          : i == last_x ? kept(j, last_y, TileDetail::east)
                                        : j;
    return static_cast<std::uint32_t>(y * xs.size() + x);
  };
  const auto is_hole = [&](std::uint32_t v) {
    return picture_.is_hole(xs[v % xs.size()], ys[v / xs.size()]);
  };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a != b && b != c && c != a && !is_hole(a) && !is_hole(b) && !is_hole(c)) {
      mesh.indices.insert(mesh.indices.end(), {a, b, c});
    }
  };
  for (std::size_t j = 0; j < last_y; ++j) {
    for (std::size_t i = 0; i < last_x; ++i) {
      add(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
      add(vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
    }
  }
  return mesh;
}

void add_heightmap(GreyImage picture, const glm::dvec3& size_m, BodyPart part, World& world, std::size_t body,
                   std::vector<BodyPart>& parts) {
  const bool mapped = part.normal_map != nullptr;
  constexpr int most_of_one_mesh_px = 2 * Terrain::tile_px + 1;
  if (picture.width_px <= most_of_one_mesh_px && picture.height_px <= most_of_one_mesh_px) {
    TriangleMesh mesh = validated_mesh(make_heightfield(picture, size_m, {}), world.diagnostics);
    if (mesh.indices.empty()) {
      throw WorldError("the heightmap is too small to have triangles");
    }
    if (mapped) {
      add_tangents(mesh);
    }
    part.mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
    parts.push_back(std::move(part));
    return;
  }
  const auto terrain = std::make_shared<const Terrain>(std::move(picture), size_m, mapped);
  world.terrains.push_back({terrain, body, parts.size()});
  constexpr int coarsest = Terrain::coarsest_level;
  for (std::size_t tile = 0; tile < terrain->tiles().size(); ++tile) {
    part.mesh = std::make_shared<const TriangleMesh>(
        terrain->mesh(tile, {coarsest, {coarsest, coarsest, coarsest, coarsest}}));
    parts.push_back(part);
  }
}

}  // namespace sonard::render
