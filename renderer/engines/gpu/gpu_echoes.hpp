// SPDX-License-Identifier: Apache-2.0
// From the visible segments of slices to the mean echo, by compute shaders: SlicePatcher and BeamSums on the
// GPU.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/engines/gpu/compute.hpp"
#include "renderer/engines/gpu/ping_buffers.hpp"
#include "renderer/engines/slices/part_surface.hpp"
#include "renderer/engines/slices/slice_accuracy.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

class GpuSurfaces;

/// The surfaces of a world on the GPU, and the shaders for their echoes. The context must be current in every
/// call. All state of a ping is in its PingBuffers, so that several pings can be in flight.
class GpuEchoes {
 public:
  /// @param compute must outlive it
  explicit GpuEchoes(const Compute& compute);
  ~GpuEchoes();
  GpuEchoes(const GpuEchoes&) = delete;
  GpuEchoes& operator=(const GpuEchoes&) = delete;

  /// Uploads what shades the parts that a fan may see: materials, vertex normals, normal maps.
  /// @param version changes with the surfaces
  void hold_surfaces(const std::vector<PartSurface>& surfaces, std::size_t version,
                     const std::vector<bool>& may_be_seen);
  const GpuSurfaces& surfaces() const;

  struct Setting {
    const Aperture& aperture;
    const RangeBins& range;
    const SurfaceModel& surface;
    const SliceAccuracy& accuracy;  ///< without within_facets: masks are made by engine `cpu`
    const BinningOptions& options;  ///< footprints and beams by azimuth only
  };
  /// Lets the GPU make the image of a ping and read it back. Does not wait.
  /// @param ping with the visible segments of its slices; slices that are divided have no echo
  /// @param placed the surfaces of hold_surfaces(), with their poses in this ping
  /// @throws RendererError if a shader does not build
  void make(PingBuffers& ping, const std::vector<PartSurface>& placed, const Setting& setting);

  /// Waits for the result of make().
  /// @param setting of make()
  /// @param memory reused for BinningResult::echo, with any contents
  /// @return nullopt if a buffer was too small: repeat the ping, which has more room now
  /// @throws RendererError if the context is lost
  std::optional<BinningResult> take(PingBuffers& ping, const Setting& setting,
                                    std::vector<float> memory) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
