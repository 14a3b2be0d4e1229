// SPDX-License-Identifier: Apache-2.0
// One ping by the CPU engine and by the shaders, from the same slices.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/binning/range_profile.hpp"
#include "renderer/engines/cpu/slice_binner.hpp"
#include "renderer/engines/cpu/slice_sampler.hpp"
#include "renderer/engines/gpu/gpu_echoes.hpp"
#include "renderer/engines/gpu/gpu_slices.hpp"
#include "renderer/engines/slices/slice_world.hpp"
#include "renderer/scene/refracted_world.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/support/gl_context_test.hpp"

namespace sonard::test {

using namespace render;

struct Ping {
  World world;
  Pose T_world_sonar;
  SonarSettings settings;
  bool open_water = false;
  double bend_per_m = 0.0;  ///< see EchoEngine::set_refraction()
  SkipSwitches skip{};

  explicit Ping(const Scene& scene)
      : world(scene.world), T_world_sonar(scene.T_world_sonar), settings(scene.settings) {}
};

/// The GPU sees the slices that the CPU engine has chosen.
class BothSides {
 public:
  explicit BothSides(EglContext& context, const Ping& ping, const GpuOptions& gpu = {})
      : ping_(ping),
        world_(ping.bend_per_m == 0.0 ? ping.world : refractable(ping.world, 2 * ping.bend_per_m)),
        of_ping_({ping.T_world_sonar, ping.settings, ping.open_water}, ping.skip, largest_response(world_)),
        sampler_(world_, workers_, ping.skip),
        parts_(world_, ping.skip),
        slices_(context, gpu),
        echoes_(slices_.compute()) {
    sampler_.set_refraction(ping.bend_per_m);
    parts_.set_refraction(ping.bend_per_m);
    parts_.place(ping.T_world_sonar);
    of_ping_.bend = parts_.bend();
    cells_ = sampler_.sample(ping.T_world_sonar, ping.settings.aperture, ping.settings.range,
                             ping.settings.range.sampled_range_m(), of_ping_.surface, of_ping_.accuracy);
    for (const SliceCell* cell : cells_) {
      GpuSlice& slice = gpu_cells.emplace_back();
      slice.cosine = cell->slice.cosine;
      slice.sine = cell->slice.sine;
      slice.width_rad = cell->slice.width_rad;
      slice.beam = cell->beam;
    }
    echoes_.surfaces().hold(parts_.surfaces(), 1, std::vector<bool>(parts_.surfaces().size(), true));
    buffers.room = {1U << 16U, 1U << 18U, 1U << 20U, 1U << 21U, 1U << 13U, 1U << 20U, 1U << 14U, 1U << 14U};
  }

  BinningResult of_cpu() {
    return bin_echoes(sampler_, cells_, ping_.settings.aperture, ping_.settings.range, of_ping_.options,
                      workers_, {});
  }

  /// The echo of the CPU engine's patches, each binned by itself. bin_echoes() gives ends that are joined one
  /// smear, which displaces the echo of patches narrower than a few thousandths of a line.
  std::vector<float> of_lone_patches() const {
    const auto lines = static_cast<std::size_t>(ping_.settings.range.count);
    const std::vector<double>& edges = ping_.settings.aperture.beam_edges_rad;
    std::vector<float> image((edges.size() - 1) * lines), weight(lines);
    std::vector<EchoPatch> patches;
    for (std::size_t cell = 0, beam = 0; beam + 1 < edges.size(); ++beam) {
      patches.clear();
      for (; cell < cells_.size() && static_cast<std::size_t>(cells_[cell]->beam) == beam; ++cell) {
        sampler_.make_patches(*cells_[cell], patches);
      }
      const double solid_angle =
          (edges[beam] - edges[beam + 1]) * 2 * std::sin(ping_.settings.aperture.elevation_limit_rad());
      float* const echo = &image[beam * lines];
      bin(patches, &EchoPatch::echo, &EchoPatch::echo_gradient, solid_angle, echo);
      if (of_ping_.options.mean) {
        bin(patches, &EchoPatch::weight, &EchoPatch::weight_gradient, solid_angle, weight.data());
        for (std::size_t k = 0; k < lines; ++k) {
          const float least_weight = full_share * static_cast<float>(solid_angle);
          echo[k] = std::min(1.0F, echo[k] / std::max(weight[k], least_weight));
        }
      }
    }
    return image;
  }

  /// Gives the ping to the GPU, without waiting.
  /// @param chosen_by_cpu false: the GPU chooses the slices
  void begin(PingBuffers& in, bool chosen_by_cpu = true) {
    slices_.find(in, parts_.parts(), of_ping_, chosen_by_cpu ? gpu_cells : std::vector<GpuSlice>{});
    slices_.see(in, of_ping_, chosen_by_cpu ? 1 : GpuSlices::most_rounds);
    echoes_.make(in, parts_.surfaces(), of_ping_);
  }
  std::optional<BinningResult> finish(PingBuffers& in) const { return GpuEchoes::take(in, of_ping_, {}); }

  /// Repeats the ping until all buffers are large enough.
  BinningResult of_gpu(bool chosen_by_cpu = true) {
    for (tries = 1; tries < 10; ++tries) {
      begin(buffers, chosen_by_cpu);
      if (auto result = finish(buffers)) {
        return std::move(*result);
      }
    }
    throw std::runtime_error("the buffers never suffice");
  }

  const Compute& compute() const { return slices_.compute(); }

  /// Number of pieces in the place of which several patches lie side by side.
  std::size_t count_beside() const {
    const auto patches = read_back<records::Patch>(buffers.gl, buffers.pieces, buffers.counted.needed.pieces);
    return static_cast<std::size_t>(std::ranges::count(
        patches, records::is_elsewhere,
        [](const records::Patch& patch) { return std::bit_cast<std::uint32_t>(patch.range_a); }));
  }

 private:
  void bin(const std::vector<EchoPatch>& patches, float EchoPatch::*amount, float EchoPatch::*gradient,
           double largest, float* to) const {
    const RangeBins& range = ping_.settings.range;
    const double per_m = 1.0 / range.step_m;
    const auto of_smears = static_cast<float>(per_m);
    RangeProfile profile;
    profile.reset(static_cast<std::size_t>(range.count), largest);
    for (const EchoPatch& p : patches) {
      profile.add(static_cast<double>(p.range_a_m) * per_m, p.smear_a_m * of_smears,
                  static_cast<double>(p.range_b_m) * per_m, p.smear_b_m * of_smears, p.*amount, p.*gradient);
      profile.finish();
    }
    profile.read(to);
  }

  const Ping& ping_;
  const World world_;
  GpuPing of_ping_;
  WorkerPool workers_{2};
  SliceSampler sampler_;
  SliceWorld parts_;
  GpuSlices slices_;
  GpuEchoes echoes_;
  std::vector<const SliceCell*> cells_;

 public:
  std::vector<GpuSlice> gpu_cells;
  PingBuffers buffers{slices_.compute().gl()};
  int tries = 0;  ///< of the last of_gpu()
};

struct Difference {
  double rms = 0.0;     ///< of bins, re the RMS of the image
  double totals = 0.0;  ///< largest of a beam, re the largest total of a beam
};

inline Difference difference(const std::vector<float>& expected, const std::vector<float>& found, int lines) {
  double squares = 0, off = 0, largest = 0, worst = 0;
  EXPECT_EQ(expected.size(), found.size());
  for (auto a = expected.begin(), b = found.begin(); a != expected.end();) {
    double total = 0, total_off = 0;
    for (int k = 0; k < lines; ++k, ++a, ++b) {
      const auto echo = static_cast<double>(*a), by = static_cast<double>(*b) - echo;
      squares += echo * echo;
      off += by * by;
      total += echo;
      total_off += by;
    }
    largest = std::max(largest, total);
    worst = std::max(worst, std::abs(total_off));
  }
  EXPECT_GT(largest, 0.0) << "there is an echo";
  return {std::sqrt(off / squares), worst / largest};
}

}  // namespace sonard::test
