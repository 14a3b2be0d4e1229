#include "renderer/visibility/ray_sampler.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr std::size_t tiles_per_job =
    64;  // 1024 rays: some ten microseconds, and too few to share when alone

bool same_pixels(const SubView& a, const SubView& b) {
  return a.azimuth_rad == b.azimuth_rad && a.tan_half_width == b.tan_half_width &&
         a.tan_half_height == b.tan_half_height && a.columns == b.columns && a.rows == b.rows;
}

int tile_count(int pixels) {
  return (pixels + packet_side - 1) / packet_side;
}

/// The pixel of a view, or the last one where the tile reaches beyond it.
std::size_t held(int pixel, int count) {
  return static_cast<std::size_t>(std::min(pixel, count - 1));
}

}  // namespace

RaySampler::View::View(const SubView& view) : geometry(view) {
  const double cosine = std::cos(view.azimuth_rad);
  const double sine = std::sin(view.azimuth_rad);
  starboard = {static_cast<float>(sine), static_cast<float>(-cosine), 0.0F};
  for (int column = 0; column < view.columns; ++column) {
    const double x = -view.tan_half_width + (column + 0.5) * view.pixel_width();
    tangent_x.push_back(static_cast<float>(x));
    ray_x.push_back(static_cast<float>(cosine + x * sine));
    ray_y.push_back(static_cast<float>(sine - x * cosine));
  }
  for (int row = 0; row < view.rows; ++row) {
    tangent_y.push_back(static_cast<float>(-view.tan_half_height + (row + 0.5) * view.pixel_height()));
  }
}

RaySampler::RaySampler(const World& world, WorkerPool& workers, const std::string& embree_settings)
    : workers_(workers),
      scene_(world, workers, embree_settings),
      description_("ray, " + scene_.description()) {}

bool RaySampler::set_body_pose(const std::string& body_name, const Pose& T_world_body) {
  return scene_.set_body_pose(body_name, T_world_body);
}

/// Lists the tiles that hold pixels of the grid. They stay the same for as long as the grid does.
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
    used.emplace_back(static_cast<std::size_t>(tile_count(view.columns)), Rows{view.rows, 0});
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
    for (int row = 0; row < view.rows; row += packet_side) {
      for (int column = 0; column < view.columns; column += packet_side) {
        const Rows& rows = used_[v][static_cast<std::size_t>(column / packet_side)];
        if (row < rows.end && row + packet_side > rows.begin) {
          tiles_.push_back({v, column, row});
        }
      }
    }
  }
}

std::vector<const SurfaceSample*> RaySampler::sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                                     const SurfaceModel& surface, double max_range_m) {
  prepare(grid);
  scene_.place(T_world_sonar);
  const std::size_t jobs = (tiles_.size() + tiles_per_job - 1) / tiles_per_job;
  workers_.run(static_cast<int>(jobs), [&](int job) {
    const std::size_t begin = static_cast<std::size_t>(job) * tiles_per_job;
    const std::size_t end = std::min(begin + tiles_per_job, tiles_.size());
    for (std::size_t i = begin; i < end; ++i) {
      trace(tiles_[i], surface, static_cast<float>(max_range_m));
    }
  });
  std::vector<const SurfaceSample*> samples;
  for (const View& view : views_) {
    samples.push_back(view.samples.data());
  }
  return samples;
}

SONARD_SIMD_CLONES void RaySampler::trace(const Tile& tile, const SurfaceModel& surface, float max_range_m) {
  View& view = views_[tile.view];
  const SubView& geometry = view.geometry;
  RayPacket rays;
  Lanes<float> tangent_x;
  for (std::size_t i = 0; i < packet_size; ++i) {
    const std::size_t column = held(tile.column + packet_column(static_cast<int>(i)), geometry.columns);
    rays.x[i] = view.ray_x[column];
    rays.y[i] = view.ray_y[column];
    rays.z[i] = view.tangent_y[held(tile.row + packet_row(static_cast<int>(i)), geometry.rows)];
    tangent_x[i] = view.tangent_x[column];
  }
  rays.step_x = view.starboard * static_cast<float>(geometry.pixel_width());
  rays.step_y = {0.0F, 0.0F, static_cast<float>(geometry.pixel_height())};

  // No ray of a view is shorter than its axis, so the depth reaches no less far than the range.
  SurfacePacket surfaces;
  scene_.trace(rays, surface, max_range_m, surfaces);

  alignas(64) std::array<SurfaceSample, packet_size> samples;
  for (std::size_t i = 0; i < packet_size; ++i) {
    // Equation (2) of docs/physics.md 2.3: n.q, and n times the two directions of the tangents.
    const float nq = surfaces.normal_x[i] * rays.x[i] + surfaces.normal_y[i] * rays.y[i] +
                     surfaces.normal_z[i] * rays.z[i];
    const float nx = surfaces.normal_x[i] * view.starboard.x + surfaces.normal_y[i] * view.starboard.y;
    const float qq = 1.0F + tangent_x[i] * tangent_x[i] + rays.z[i] * rays.z[i];
    SurfaceSample sample;
    sample.range_m = surfaces.depth[i] * std::sqrt(qq);
    sample.response = surfaces.response[i];
    sample.range_dx = sample.range_m * (tangent_x[i] / qq - nx / nq);
    sample.range_dy = sample.range_m * (rays.z[i] / qq - surfaces.normal_z[i] / nq);
    // A sum is finite when all its terms are.
    const float sum = sample.range_m + sample.response + sample.range_dx + sample.range_dy;
    samples[i] = surfaces.depth[i] == 0.0F ? SurfaceSample{}
                 : std::isfinite(sum)      ? sample
                                           : SurfaceSample{-1.0F, 0.0F, 0.0F, 0.0F};
  }
  const int columns = std::min(packet_side, geometry.columns - tile.column);
  const int rows = std::min(packet_side, geometry.rows - tile.row);
  for (std::size_t i = 0; i < packet_size; ++i) {
    const int column = packet_column(static_cast<int>(i));
    const int row = packet_row(static_cast<int>(i));
    if (column < columns && row < rows) {
      view.samples[static_cast<std::size_t>(tile.row + row) * static_cast<std::size_t>(geometry.columns) +
                   static_cast<std::size_t>(tile.column + column)] = samples[i];
    }
  }
}

}  // namespace sonard::render
