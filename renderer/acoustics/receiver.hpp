// From mean echo to device samples: speckle, noise, gain, range compression, quantiser.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/sonar_renderer.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// The receiver of all sonars that share a renderer. One thread calls it. Mode `physical` with speckle `ou`
/// keeps a field per stream, so that speckle survives small motions as it does in the water; everything else
/// is a pure function of the request.
class Receiver {
 public:
  /// @param echo mean echo intensity as EchoImage states it.
  PingSamples receive(const EchoImage& echo, const PingRequest& request, int stream, WorkerPool& workers);

 private:
  /// White complex Gaussians under the speckle of one stream, per native line, wider than the fan by the
  /// kernel.
  struct SpeckleField {
    int width = 0;
    int lines = 0;
    std::uint64_t seed = 0;
    Pose T_world_sonar;
    std::vector<float> real, imaginary;  ///< [line * width + column]
  };

  struct SpeckleStep;
  SpeckleStep advance_speckle(const PingRequest& request, int stream, int width);

  std::map<int, SpeckleField> speckle_;
};

/// Time-varying gain and gain setting of mode `physical` per native line, as amplitude.
std::vector<float> tvg_amplitudes(const PhysicalModel& model, const RangeLines& range);

}  // namespace sonard::render
