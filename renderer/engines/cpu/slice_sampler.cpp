// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_sampler.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/engines/cpu/slice_sampler_impl.hpp"
#include "renderer/engines/slices/first_slices.hpp"

namespace sonard::render {

SliceSampler::SliceSampler(const World& world, WorkerPool& workers, const SkipSwitches& skip)
    : workers_(workers), skip_(skip), world_(world, skip) {}

SliceSampler::~SliceSampler() = default;

const SliceSampler::Elevations& SliceSampler::elevations_of(const Aperture& aperture, float tan_limit) {
  if (!elevations_ || elevations_->elevation != aperture.elevation ||
      elevations_->vertical_beamwidth_rad != aperture.vertical_beamwidth_rad) {
    elevations_ = std::make_unique<const Elevations>(Elevations{
        aperture.elevation, aperture.vertical_beamwidth_rad,
        ElevationPattern(aperture, !skip_.on(SkipRule::flat_elevation)), probe_weights(aperture, tan_limit)});
  }
  return *elevations_;
}

std::size_t SliceSampler::new_cell(const Slice& slice, int beam) {
  if (cells_used_ == cells_.size()) {
    cells_.push_back(std::make_unique<SliceCell>());
  }
  SliceCell& cell = *cells_[cells_used_];
  cell.slice = slice;
  cell.beam = beam;
  cell.seen = false;
  cell.fresh = true;
  cell.to_starboard = {};
  cell.edge_at_starboard.reset();
  return cells_used_++;
}

void SliceSampler::lay_first_slices(const Setting& setting) {
  cells_used_ = 0;
  order_.clear();
  for (const FirstSlice& first :
       first_slices(setting.fan, static_cast<double>(setting.line_m), setting.accuracy)) {
    order_.push_back(new_cell({first.azimuth_rad, static_cast<float>(first.width_rad)}, first.beam));
  }
}

std::vector<const SliceCell*> SliceSampler::sample(const Pose& T_world_sonar, const Aperture& aperture,
                                                   const RangeBins& range, double sampled_range_m,
                                                   const SurfaceModel& surface,
                                                   const SliceAccuracy& accuracy) {
  world_.place(T_world_sonar);
  const Fan fan(aperture, sampled_range_m);
  const Elevations& elevations = elevations_of(aperture, fan.tan_limit());
  setting_ = std::make_unique<const Setting>(
      Setting{fan, elevations.pattern, surface, accuracy, world_.surfaces(), world_.any_mapped(),
              world_.any_vertex_normals(), world_.any_facets(surface), static_cast<float>(range.step_m),
              SideView(elevations.probes, fan.tan_limit(), static_cast<float>(range.max_range_m()),
                       static_cast<float>(range.step_m))});
  triangles_.find(world_.parts(), fan, world_.bend(), workers_, skip_);
  if (setting_->any_vertex_normals) {
    vertex_normals_.find(triangles_, world_.surfaces(), workers_);
  }
  lay_first_slices(*setting_);
  std::vector<std::size_t> fresh = order_;
  do {
    see(*setting_, fresh);
  } while (refine(*setting_, fresh));
  std::vector<const SliceCell*> cells;
  for (const std::size_t i : order_) {
    cells.push_back(cells_[i].get());
  }
  skipped_ = world_.skipped();
  skipped_.add(SkipRule::culled_clusters, triangles_.clusters_culled());
  skipped_.add(SkipRule::hidden_faces, triangles_.faces_hidden());
  skipped_.add(SkipRule::flat_elevation, setting_->pattern.flat() ? 1 : 0);
  return cells;
}

/// Fills the cells `fresh`, which run from port to starboard. One job has all cells of a beam, unless these
/// are so many that other threads would be idle.
void SliceSampler::see(const Setting& setting, const std::vector<std::size_t>& fresh) {
  constexpr std::size_t jobs_per_thread = 4;
  const std::size_t longest = std::max<std::size_t>(1, fresh.size() / (jobs_per_thread * workers_.size()));
  std::vector<std::size_t> begins;  // of each job in `fresh`
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    if (i == 0 || cells_[fresh[i]]->beam != cells_[fresh[i - 1]]->beam || i - begins.back() >= longest) {
      begins.push_back(i);
    }
  }
  begins.push_back(fresh.size());
  workers_.run(static_cast<int>(begins.size()) - 1, [&](int job) {
    thread_local Scratch scratch;
    const auto j = static_cast<std::size_t>(job);
    const SliceCell& first = *cells_[fresh[begins[j]]];
    const SliceCell& last = *cells_[fresh[begins[j + 1] - 1]];
    scratch.cutter.load(triangles_.of_beam(first.beam),
                        last.slice.azimuth_rad - 0.5 * static_cast<double>(last.slice.width_rad),
                        first.slice.azimuth_rad + 0.5 * static_cast<double>(first.slice.width_rad),
                        setting.fan, setting.surface.two_sided);
    for (std::size_t i = begins[j]; i < begins[j + 1]; ++i) {
      see_cell(setting, scratch, *cells_[fresh[i]]);
    }
  });
}

void SliceSampler::see_cell(const Setting& setting, Scratch& scratch, SliceCell& cell) {
  if (!cell.seen) {
    scratch.cutter.cut(cell.slice, setting.fan.tan_limit(), scratch.segments);
    scratch.sweep.run(scratch.cutter, cell.slice, scratch.segments, setting.fan.tan_limit(), cell.visible);
    cell.seen = true;
  }
  if (setting.accuracy.most_divisions == 1) {
    return;
  }
  cell.missed_share = scratch.cutter.missed_height(cell.slice) / (2 * setting.fan.tan_limit());
  scratch.cutter.find_upright_edges(cell.slice, cell.edges);
  scratch.expectation.find(cell.visible, cell.slice.width_rad, setting.side_view, cell.sides);
}

std::uint64_t SliceSampler::make_patches(const SliceCell& cell, std::vector<EchoPatch>& patches) const {
  thread_local SlicePatcher patcher;
  const Setting& setting = *setting_;
  const std::uint64_t without_facets =
      patcher.make({.slice = cell.slice,
                    .visible = cell.visible,
                    .parts = setting.parts,
                    .surface = setting.surface,
                    .pattern = setting.pattern,
                    .tan_limit = setting.fan.tan_limit(),
                    .linearity = setting.accuracy.linearity,
                    .any_mapped = setting.any_mapped,
                    .mapped_lines = setting.accuracy.mapped_lines,
                    .vertex_normals = setting.any_vertex_normals ? &vertex_normals_ : nullptr,
                    .any_facets = setting.any_facets,
                    .facet_slopes = setting.accuracy.facet_slopes,
                    .facet_lines = setting.accuracy.facet_lines,
                    .line_m = setting.line_m,
                    .sampled_range_m = setting.fan.sampled_range_m(),
                    .within_facets = setting.accuracy.within_facets},
                   patches);
  return setting.surface.facets == Facets::near_normal ? without_facets : 0;
}

}  // namespace sonard::render
