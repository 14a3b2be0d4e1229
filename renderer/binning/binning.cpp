// SPDX-License-Identifier: Apache-2.0
#include "renderer/binning/binning.hpp"

#include <utility>

namespace sonard::render {

BinningOptions binning_options(const EchoRequest& request, const SkipSwitches& skip, float largest_response) {
  const SonarSettings& settings = request.settings;
  BinningOptions options;
  options.skip = skip;
  options.open_water = request.open_water;
  options.largest_response = largest_response;
  options.footprint = settings.sampling.footprint;
  if (settings.model == Model::paper) {
    options.mean = true;
    options.footprint = options.footprint && settings.paper.footprint;
    options.legacy_bin_index = settings.paper.legacy_bin_index && !options.footprint;
  }
  options.cone_aperture = has_conical_beams(settings) ? &settings.aperture : nullptr;
  return options;
}

void hand_over(BinningResult&& bins, MeanEcho& echo, PingStatistics& statistics) {
  echo.image = {bins.beams, bins.lines, std::move(bins.echo)};
  echo.open_sr = std::move(bins.open_sr);
  statistics.samples += bins.samples;
  statistics.invalid_samples += bins.invalid_samples;
  statistics.skipped += bins.skipped;
}

}  // namespace sonard::render
