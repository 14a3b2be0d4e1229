// SPDX-License-Identifier: Apache-2.0
// Visibility in azimuth slices by compute shaders: the stages of SliceSampler, on the GPU.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "renderer/engines/gpu/compute.hpp"
#include "renderer/engines/gpu/ping_buffers.hpp"
#include "renderer/engines/slices/fan.hpp"
#include "renderer/engines/slices/first_slices.hpp"
#include "renderer/engines/slices/mesh_clusters.hpp"
#include "renderer/engines/slices/slice_accuracy.hpp"
#include "renderer/scene/refraction.hpp"
#include "renderer/skip_ledger.hpp"

namespace sonard::render {

class EglContext;
class GpuMeshes;

/// The triangles of a world on the GPU, and the shaders that find what slices of a fan see of them. All state
/// of a ping is in its PingBuffers, so that several pings can be in flight. The context must be current in
/// every call.
class GpuSlices {
 public:
  struct Options {
    int group = 0;  ///< invocations of a group, each with a piece of the sweep; 0: as many as suit the device
    int segments = 960;  ///< of a slice that are seen at a time; 960 fit in 32 KiB, which every OpenGL has
    std::uint64_t memory_mib = 4096;  ///< bound of the meshes, GpuOptions::memory_mib
    bool time_stages = false;         ///< GpuOptions::time_stages
  };
  /// @throws RendererError if a shader does not build
  explicit GpuSlices(EglContext& context);
  GpuSlices(EglContext& context, const Options& options);
  ~GpuSlices();
  GpuSlices(const GpuSlices&) = delete;
  GpuSlices& operator=(const GpuSlices&) = delete;

  struct PingSetting {
    const Fan& fan;
    const ProbeWeights& weights;
    float line_m, max_range_m;  ///< of the range lines
    SliceAccuracy accuracy{};
    Refraction bend{};
    bool two_sided = true;  ///< false: triangles seen from behind are invisible
    SkipSwitches skip{};
    std::uint64_t surface_bytes = 0;  ///< in video memory beside the meshes, within the same bound
    std::vector<bool> may_be_seen{};  ///< of each part: GpuSlices::may_be_seen(); empty: all may be
  };
  /// Of each part, false only if the fan misses it.
  static std::vector<bool> may_be_seen(const std::vector<PlacedPart>& parts, const PingSetting& setting);

  /// Begins a ping: uploads the parts that the fan may see, places them, and lists their triangles for each
  /// beam.
  /// @param slices with which the ping begins; empty: first_slices()
  /// @throws RequestError, RendererError as GpuMeshes::hold()
  void find(PingBuffers& ping, const std::vector<PlacedPart>& parts, const PingSetting& setting,
            const std::vector<GpuSlice>& slices = {});

  static constexpr int most_rounds = 12;
  /// Sees the slices, and divides them where they disagree or miss something. Does not wait for the GPU.
  /// @param rounds 1: none is divided
  void see(PingBuffers& ping, const PingSetting& setting, int rounds = most_rounds) const;

  const Compute& compute() const;
  const GpuMeshes& meshes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::render
