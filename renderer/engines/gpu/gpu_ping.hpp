// SPDX-License-Identifier: Apache-2.0
// What the stages of slices on the GPU know of one ping.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/engines/slices/fan.hpp"
#include "renderer/engines/slices/first_slices.hpp"
#include "renderer/engines/slices/slice_accuracy.hpp"
#include "renderer/scene/refraction.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

struct GpuPing {
  /// @param request its settings must outlive the ping
  /// @param largest_response of any surface of the world
  GpuPing(const EchoRequest& request, const SkipSwitches& skip, float largest_response)
      : settings(request.settings),
        options(binning_options(request, skip, largest_response)),
        surface(surface_model(settings, skip)),
        accuracy(slice_accuracy(settings.sampling, settings.model)),
        fan(settings.aperture, settings.range.sampled_range_m()),
        weights(probe_weights(settings.aperture, fan.tan_limit())) {}

  const SonarSettings& settings;
  BinningOptions options;
  SurfaceModel surface;
  SliceAccuracy accuracy;  ///< without within_facets: masks are made by engine `cpu`
  Fan fan;
  ProbeWeights weights;
  Refraction bend{};
  std::vector<bool> may_be_seen{};  ///< of each part: GpuSlices::may_be_seen(); empty: all may be
  std::uint64_t surface_bytes = 0;  ///< in video memory beside the meshes, within the same bound
};

}  // namespace sonard::render
