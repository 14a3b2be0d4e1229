// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/ray_sampler.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "renderer/scene/refracted_world.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr std::size_t tiles_per_job = 64;  // 1024 rays: about ten microseconds, too few to split further

bool same_pixels(const SubView& a, const SubView& b) {
  return a.azimuth_rad == b.azimuth_rad && a.tan_half_width == b.tan_half_width &&
         a.tan_half_height == b.tan_half_height && a.columns == b.columns && a.rows == b.rows;
}

std::size_t tile_count(int pixels) {
  return static_cast<std::size_t>((pixels + packet_side - 1) / packet_side);
}

/// Pixel `i` of tile number `tile`, or the last pixel of the view if the tile reaches beyond it.
int pixel_of(std::size_t tile, int i, int count) {
  return std::min(static_cast<int>(tile) * packet_side + i, count - 1);
}

}  // namespace

RaySampler::View::View(const SubView& view) : geometry(view) {
  tangent_x.resize(tile_count(view.columns));
  tangent_y.resize(tile_count(view.rows));
  middle_x.resize(tangent_x.size());
  middle_y.resize(tangent_x.size());
  middle_z.resize(tangent_x.size());
  for (std::size_t lane = 0; lane < packet_size; ++lane) {
    const int in_row = static_cast<int>(lane) % packet_side;
    const int in_column = static_cast<int>(lane) / packet_side;
    for (std::size_t tile = 0; tile < tangent_x.size(); ++tile) {
      const int column = pixel_of(tile, in_row, view.columns);
      tangent_x[tile][lane] = static_cast<float>(-view.tan_half_width + (column + 0.5) * view.pixel_width());
    }
    for (std::size_t tile = 0; tile < tangent_y.size(); ++tile) {
      const int row = pixel_of(tile, in_column, view.rows);
      tangent_y[tile][lane] = static_cast<float>(-view.tan_half_height + (row + 0.5) * view.pixel_height());
    }
  }
}

void RaySampler::View::turn(const glm::dquat& R_world_sonar) {
  const double cosine = std::cos(geometry.azimuth_rad);
  const double sine = std::sin(geometry.azimuth_rad);
  const glm::vec3 axis(R_world_sonar * glm::dvec3(cosine, sine, 0));
  starboard = glm::vec3(R_world_sonar * glm::dvec3(sine, -cosine, 0));
  up = glm::vec3(R_world_sonar * glm::dvec3(0, 0, 1));
  for (std::size_t tile = 0; tile < tangent_x.size(); ++tile) {
    for (std::size_t lane = 0; lane < packet_size; ++lane) {
      const float x = tangent_x[tile][lane];
      middle_x[tile][lane] = axis.x + x * starboard.x;
      middle_y[tile][lane] = axis.y + x * starboard.y;
      middle_z[tile][lane] = axis.z + x * starboard.z;
    }
  }
}

RaySampler::RaySampler(SpatialIndex& index, WorkerPool& workers) : index_(index), workers_(workers) {
  std::map<const NormalMap*, std::shared_ptr<const NormalPyramid>> pyramids;
  for (const Body& body : index.world().bodies) {
    for (const BodyPart& part : body.parts) {
      std::shared_ptr<const NormalPyramid>& pyramid = pyramids[part.normal_map.get()];
      if (part.normal_map && !pyramid) {
        pyramid = std::make_shared<const NormalPyramid>(*part.normal_map);
      }
      shaders_.emplace_back(part, pyramid);
    }
  }
}

/// Lists the tiles that hold pixels of the grid, if the grid has changed.
void RaySampler::prepare(const SampleGrid& grid) {
  const bool same_views =
      std::equal(views_.begin(), views_.end(), grid.views.begin(), grid.views.end(),
                 [](const View& view, const SubView& wanted) { return same_pixels(view.geometry, wanted); });
  if (!same_views) {
    views_.clear();
    for (const SubView& view : grid.views) {
      views_.emplace_back(view);
    }
  }
  std::vector<std::vector<Rows>> used;
  for (const SubView& view : grid.views) {
    used.emplace_back(tile_count(view.columns), Rows{view.rows, 0});
  }
  for (const ColumnPart& part : grid.parts) {
    Rows& rows =
        used[static_cast<std::size_t>(part.view)][static_cast<std::size_t>(part.column / packet_side)];
    rows.begin = std::min(rows.begin, part.row_begin);
    rows.end = std::max(rows.end, part.row_end);
  }
  if (same_views && used == used_) {
    return;
  }
  used_ = std::move(used);
  tiles_.clear();
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const SubView& view = views_[v].geometry;
    views_[v].samples.assign(static_cast<std::size_t>(view.columns) * static_cast<std::size_t>(view.rows),
                             {});
    for (std::size_t row = 0; row < tile_count(view.rows); ++row) {
      const int first = static_cast<int>(row) * packet_side;
      for (std::size_t column = 0; column < tile_count(view.columns); ++column) {
        const Rows& rows = used_[v][column];
        if (first < rows.end && first + packet_side > rows.begin) {
          tiles_.push_back({v, column, row});
        }
      }
    }
  }
}

std::vector<const SurfaceSample*> RaySampler::sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                                     const SurfaceModel& surface, double max_range_m) {
  prepare(grid);
  for (View& view : views_) {
    view.turn(T_world_sonar.orientation);
  }
  if (bend_per_m_ == 0.0) {
    index_.place(T_world_sonar.position_m);
    trace_tiles(index_, surface, static_cast<float>(max_range_m));
  } else {
    SpatialIndex refracted(refracted_world(index_.world(), T_world_sonar.position_m, bend_per_m_), workers_);
    refracted.place(glm::dvec3(0.0));
    trace_tiles(refracted, surface, static_cast<float>(max_range_m));
  }
  std::vector<const SurfaceSample*> samples;
  for (const View& view : views_) {
    samples.push_back(view.samples.data());
  }
  return samples;
}

void RaySampler::trace_tiles(const SpatialIndex& index, const SurfaceModel& surface, float max_range_m) {
  place_shaders(index);
  const std::size_t jobs = (tiles_.size() + tiles_per_job - 1) / tiles_per_job;
  workers_.run(static_cast<int>(jobs), [&](int job) {
    const std::size_t begin = static_cast<std::size_t>(job) * tiles_per_job;
    const std::size_t end = std::min(begin + tiles_per_job, tiles_.size());
    for (std::size_t i = begin; i < end; ++i) {
      trace(index, tiles_[i], surface, max_range_m);
    }
  });
}

void RaySampler::place_shaders(const SpatialIndex& index) {
  std::size_t i = 0;
  for (const Body& body : index.world().bodies) {
    for (const BodyPart& part : body.parts) {
      shaders_[i].place(part.mesh, index.axes(i));
      ++i;
    }
  }
}

SONARD_SIMD_CLONES void RaySampler::shade(const RayPacket& rays, const RayHits& hits,
                                          const SurfaceModel& surface, SurfacePacket& surfaces) const {
  for (std::size_t i = 0; i < packet_size; ++i) {
    surfaces.depth[i] = hits.part[i] != no_part ? hits.depth[i] : 0.0F;
  }
  // Neighbours mostly hit the same part: one round shades them all.
  Lanes<std::uint32_t> waiting = hits.part;
  while (true) {
    std::uint32_t part = no_part;  // the largest number, so any waiting part is smaller
    for (std::size_t i = 0; i < packet_size; ++i) {
      part = std::min(part, waiting[i]);
    }
    if (part == no_part) {
      return;
    }
    shaders_[part].shade(rays, hits, part, surface, surfaces);
    for (std::size_t i = 0; i < packet_size; ++i) {
      waiting[i] = waiting[i] == part ? no_part : waiting[i];
    }
  }
}

SONARD_SIMD_CLONES void RaySampler::trace(const SpatialIndex& index, const Tile& tile,
                                          const SurfaceModel& surface, float max_range_m) {
  View& view = views_[tile.view];
  const glm::vec3 starboard = view.starboard;
  const glm::vec3 up = view.up;
  const Lanes<float>& tangent_x = view.tangent_x[tile.column];
  const Lanes<float>& tangent_y = view.tangent_y[tile.row];
  RayPacket rays{view.middle_x[tile.column], view.middle_y[tile.column], view.middle_z[tile.column],
                 starboard * static_cast<float>(view.geometry.pixel_width()),
                 up * static_cast<float>(view.geometry.pixel_height())};
  for (std::size_t i = 0; i < packet_size; ++i) {
    rays.x[i] += tangent_y[i] * up.x;
    rays.y[i] += tangent_y[i] * up.y;
    rays.z[i] += tangent_y[i] * up.z;
  }
  // Rays are at least as long as the axis of the view, so a depth of max_range_m covers the range.
  RayHits hits;
  index.trace(rays, max_range_m, surface.two_sided, hits);
  SurfacePacket surfaces;
  shade(rays, hits, surface, surfaces);

  alignas(64) Lanes<float> range, range_dx, range_dy, response;
  for (std::size_t i = 0; i < packet_size; ++i) {
    // Equation (2) of docs/physics.md 2.3: n times the ray and the two directions of the tangents.
    const float nx = surfaces.normal_x[i];
    const float ny = surfaces.normal_y[i];
    const float nz = surfaces.normal_z[i];
    const float n_ray = nx * rays.x[i] + ny * rays.y[i] + nz * rays.z[i];
    const float n_starboard = nx * starboard.x + ny * starboard.y + nz * starboard.z;
    const float n_up = nx * up.x + ny * up.y + nz * up.z;
    const float x = tangent_x[i];
    const float y = tangent_y[i];
    const float qq = 1.0F + x * x + y * y;
    const float r = surfaces.depth[i] * std::sqrt(qq);
    const float dx = r * (x / qq - n_starboard / n_ray);
    const float dy = r * (y / qq - n_up / n_ray);
    const bool seen = surfaces.depth[i] != 0.0F;
    // A sum is finite only if all its terms are.
    const bool valid = std::abs(r + surfaces.response[i] + dx + dy) < INFINITY;
    range[i] = !seen ? 0.0F : (valid ? r : -1.0F);
    response[i] = seen && valid ? surfaces.response[i] : 0.0F;
    range_dx[i] = seen && valid ? dx : 0.0F;
    range_dy[i] = seen && valid ? dy : 0.0F;
  }
  Lanes<SurfaceSample> samples;
  for (std::size_t i = 0; i < packet_size; ++i) {
    samples[i] = {range[i], response[i], range_dx[i], range_dy[i]};
  }
  store(samples, tile, view);
}

void RaySampler::store(const Lanes<SurfaceSample>& samples, const Tile& tile, View& view) {
  const int first_column = static_cast<int>(tile.column) * packet_side;
  const int first_row = static_cast<int>(tile.row) * packet_side;
  const int columns = std::min(packet_side, view.geometry.columns - first_column);
  const int rows = std::min(packet_side, view.geometry.rows - first_row);
  SurfaceSample* to =
      view.samples.data() + static_cast<std::ptrdiff_t>(first_row) * view.geometry.columns + first_column;
  const SurfaceSample* from = samples.data();
  for (int row = 0; row < rows; ++row, from += packet_side, to += view.geometry.columns) {
    if (columns == packet_side) {
      std::copy_n(from, packet_side, to);
    } else {
      std::copy_n(from, columns, to);
    }
  }
}

}  // namespace sonard::render
