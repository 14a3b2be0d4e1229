// SPDX-License-Identifier: Apache-2.0
// Visibility in azimuth slices by compute shaders: the stages of SliceSampler, on the GPU.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/engines/gpu/compute.hpp"
#include "renderer/engines/gpu/gpu_meshes.hpp"
#include "renderer/engines/gpu/gpu_ping.hpp"
#include "renderer/engines/gpu/ping_buffers.hpp"
#include "renderer/engines/slices/mesh_clusters.hpp"
#include "renderer/renderer_options.hpp"

namespace sonard::render {

/// The triangles of a world on the GPU, and the shaders that find what slices of a fan see of them. All state
/// of a ping is in its PingBuffers, so that several pings can be in flight. The context must be current in
/// every call.
class GpuSlices {
 public:
  /// @throws RendererError if a shader does not build
  GpuSlices(EglContext& context, const GpuOptions& options);

  /// Of each part, false only if the fan misses it.
  static std::vector<bool> may_be_seen(const std::vector<PlacedPart>& parts, const GpuPing& ping);

  /// Begins a ping: uploads the parts that the fan may see, places them, and lists their triangles for each
  /// beam.
  /// @param slices with which the ping begins; empty: first_slices()
  /// @throws RequestError if there are more slices than the shaders can count
  /// @throws RequestError, RendererError as GpuMeshes::hold()
  void find(PingBuffers& in, const std::vector<PlacedPart>& parts, const GpuPing& ping,
            const std::vector<GpuSlice>& slices = {});

  static constexpr int most_rounds = records::most_rounds;
  /// Sees the slices, and divides them where they disagree or miss something. Does not wait for the GPU.
  /// @param rounds 1: none is divided
  void see(PingBuffers& in, const GpuPing& ping, int rounds = most_rounds) const;

  const Compute& compute() const { return compute_; }
  const GpuMeshes& meshes() const { return meshes_; }

 private:
  std::size_t upload_parts(PingBuffers& in, const std::vector<PlacedPart>& placed, const GpuPing& ping);

  Compute compute_;
  GpuMeshes meshes_;
  const osg::ref_ptr<osg::Program> place_, scan_, fill_, list_things_, see_, refine_;
};

}  // namespace sonard::render
