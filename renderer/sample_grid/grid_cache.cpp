// SPDX-License-Identifier: Apache-2.0
#include "renderer/sample_grid/grid_cache.hpp"

namespace sonard::render {

bool GridCache::prepare(const Aperture& aperture, const Sampling& sampling, const GridOptions& options,
                        bool may_keep) {
  if (may_keep && made_of_ && made_of_->aperture.beam_edges_rad == aperture.beam_edges_rad &&
      made_of_->aperture.vertical_beamwidth_rad == aperture.vertical_beamwidth_rad &&
      made_of_->aperture.elevation == aperture.elevation && made_of_->sampling.views == sampling.views &&
      made_of_->sampling.columns_per_view == sampling.columns_per_view &&
      made_of_->sampling.rows == sampling.rows && made_of_->options == options) {
    return true;
  }
  made_of_.reset();
  weights_.reset();
  grid_ = make_sample_grid(aperture, sampling, options);
  made_of_ = {aperture, sampling, options};
  return false;
}

}  // namespace sonard::render
