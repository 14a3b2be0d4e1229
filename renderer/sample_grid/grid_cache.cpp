// SPDX-License-Identifier: Apache-2.0
#include "renderer/sample_grid/grid_cache.hpp"

namespace sonard::render {

namespace {

bool same_grid(const SonarSettings& a, const SonarSettings& b) {
  return a.aperture.beam_edges_rad == b.aperture.beam_edges_rad &&
         a.aperture.vertical_beamwidth_rad == b.aperture.vertical_beamwidth_rad &&
         a.aperture.elevation == b.aperture.elevation && a.sampling.views == b.sampling.views &&
         a.sampling.columns_per_view == b.sampling.columns_per_view && a.sampling.rows == b.sampling.rows &&
         grid_options(a) == grid_options(b);
}

}  // namespace

bool GridCache::prepare(const SonarSettings& settings, bool may_keep) {
  if (may_keep && made_of_ && same_grid(*made_of_, settings)) {
    return true;
  }
  made_of_.reset();
  weights_.reset();
  grid_ = make_sample_grid(settings.aperture, settings.sampling, grid_options(settings));
  made_of_ = settings;
  return false;
}

}  // namespace sonard::render
