// SPDX-License-Identifier: Apache-2.0
// From the visible segments of slices to the mean echo, by compute shaders: SlicePatcher and BeamSums on the
// GPU.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "renderer/engines/gpu/compute.hpp"
#include "renderer/engines/gpu/gpu_ping.hpp"
#include "renderer/engines/gpu/gpu_surfaces.hpp"
#include "renderer/engines/gpu/ping_buffers.hpp"
#include "renderer/engines/slices/elevation_pattern.hpp"
#include "renderer/engines/slices/part_surface.hpp"

namespace sonard::render {

/// The surfaces of a world on the GPU, and the shaders for their echoes. The context must be current in every
/// call. All state of a ping is in its PingBuffers, so that several pings can be in flight.
class GpuEchoes {
 public:
  /// @param compute must outlive it
  explicit GpuEchoes(const Compute& compute) : compute_(compute), surfaces_(compute.gl()) {}

  /// What shades the parts that a fan may see; hold them before make().
  GpuSurfaces& surfaces() { return surfaces_; }

  /// Lets the GPU make the image of a ping and read it back. Does not wait.
  /// @param in has the visible segments of its slices; slices that are divided have no echo
  /// @param placed the surfaces of GpuSurfaces::hold(), with their poses in this ping
  /// @throws RendererError if a shader does not build
  /// @param ping with footprints and beams by azimuth only
  void make(PingBuffers& in, const std::vector<PartSurface>& placed, const GpuPing& ping);

  /// Waits for the result of make().
  /// @param ping of make()
  /// @param memory reused for BinningResult::echo, with any contents
  /// @return nullopt if a buffer was too small: repeat the ping, which has more room now
  /// @throws RendererError if the context is lost
  static std::optional<BinningResult> take(PingBuffers& in, const GpuPing& ping, std::vector<float> memory);

 private:
  const osg::ref_ptr<osg::Program>& program(const std::string& name, const char* text,
                                            const std::string& defines);
  const ElevationPattern& pattern_of(const GpuPing& ping);

  const Compute& compute_;
  std::map<std::string, osg::ref_ptr<osg::Program>> programs_;  ///< by name and macros, built when first used
  GpuSurfaces surfaces_;
  // The pattern of the last ping; it takes as long as a narrow ping.
  Aperture patterned_;  ///< the aperture without beams
  std::optional<ElevationPattern> pattern_;
};

}  // namespace sonard::render
