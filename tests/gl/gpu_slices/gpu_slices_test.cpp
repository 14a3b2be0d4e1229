// SPDX-License-Identifier: Apache-2.0
// The stages of slices on the GPU against those of the CPU engine, on all slices of real pings.
#include "renderer/engines/gpu/gpu_slices.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/engines/cpu/slice_sampler.hpp"
#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/errors.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/support/gl_context_test.hpp"

namespace sonard::render {
namespace {

/// What identifies a triangle on both sides.
using TriangleKey = std::pair<std::uint32_t, std::uint32_t>;  // part, number in its mesh

std::vector<PlacedPart> placed(const World& world, const Pose& T_world_sonar) {
  std::vector<PlacedPart> parts;
  std::map<const TriangleMesh*, std::shared_ptr<const MeshClusters>> clusters;
  for (const Body& body : world.bodies) {
    for (const BodyPart& part : body.parts) {
      auto& mesh = clusters[part.mesh.get()];
      if (!mesh) {
        mesh = std::make_shared<const MeshClusters>(*part.mesh, true);
      }
      const Pose T_sonar_part = relative(T_world_sonar, body.T_world_body) * part.T_body_part;
      parts.push_back(
          {mesh, glm::mat3(glm::mat3_cast(T_sonar_part.orientation)), glm::vec3(T_sonar_part.position_m)});
    }
  }
  return parts;
}

/// Share of the elevations at which two lists show other triangles.
double differing_share(const std::vector<VisibleSegment>& cpu, const std::vector<GpuVisible>& gpu,
                       const std::vector<GpuTriangle>& triangles, float tan_limit) {
  std::vector<float> borders;
  for (const auto& segment : cpu) {
    borders.insert(borders.end(), {segment.low, segment.high});
  }
  for (const auto& segment : gpu) {
    borders.insert(borders.end(), {segment.low, segment.high});
  }
  std::sort(borders.begin(), borders.end());
  double differing = 0;
  std::size_t a = 0, b = 0;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    const float from = borders[i], to = borders[i + 1];
    while (a < cpu.size() && cpu[a].high <= from) {
      ++a;
    }
    while (b < gpu.size() && gpu[b].high <= from) {
      ++b;
    }
    TriangleKey on_cpu{~0U, 0}, on_gpu{~0U, 0};
    if (a < cpu.size() && cpu[a].low <= from) {
      on_cpu = {cpu[a].triangle->part, cpu[a].triangle->mesh_triangle};
    }
    if (b < gpu.size() && gpu[b].low <= from) {
      const GpuTriangle& t = triangles[gpu[b].triangle];
      on_gpu = {t.flags >> records::part_shift, t.mesh_triangle};
    }
    differing += on_cpu != on_gpu ? static_cast<double>(to - from) : 0.0;
  }
  return differing / (2.0 * static_cast<double>(tan_limit));
}

/// How the slices of the GPU differ from those of the CPU.
struct Comparison {
  PingCounts counts{};
  std::size_t slices = 0, same_bits = 0;
  double differing = 0;  ///< share of all elevations at which another triangle is seen
  double off_sides = 0;  ///< share of the probes with another distance
};

/// A ping of preset `default`, and the slices in which the CPU engine sees it.
struct PingOnCpu {
  test::Scene scene;
  SkipSwitches skip = SkipSwitches().turn_off(SkipRule::coplanar_facets);  // the same triangles on both
  WorkerPool workers{2};
  SliceSampler sampler{scene.world, workers, skip};
  GpuPing of_gpu{{scene.T_world_sonar, scene.settings}, skip, largest_response(scene.world)};
  std::vector<const SliceCell*> cells =
      sampler.sample(scene.T_world_sonar, scene.settings.aperture, scene.settings.range,
                     scene.settings.range.sampled_range_m(), of_gpu.surface, of_gpu.accuracy);

  explicit PingOnCpu(const std::string& scene_name) : PingOnCpu(test::make_scene(scene_name)) {}
  explicit PingOnCpu(test::Scene of_ping) : scene(std::move(of_ping)) {}
};

/// The same ping on the GPU.
class PingOnGpu {
 public:
  /// @param rounds see GpuSlices::see()
  /// @param slices with which the ping begins; empty: the GPU chooses them
  PingOnGpu(EglContext& context, const GpuOptions& options, const PingOnCpu& cpu, int rounds,
            const std::vector<GpuSlice>& slices = {})
      : gpu_(context, options) {
    const std::vector<PlacedPart> parts = placed(cpu.scene.world, cpu.scene.T_world_sonar);
    bool has_room = false;
    for (int tries = 0; tries < 8 && !has_room; ++tries) {
      gpu_.find(buffers_, parts, cpu.of_gpu, slices);
      gpu_.see(buffers_, cpu.of_gpu, rounds);
      counts = read<PingCounts>(buffers_.counts, 1)[0];
      has_room = !buffers_.grow(counts.needed);
    }
    EXPECT_TRUE(has_room);
  }

  PingCounts counts{};
  std::vector<GpuSlice> slices() const { return read<GpuSlice>(buffers_.slices, counts.needed.slices); }
  std::vector<GpuTriangle> triangles() const {
    return read<GpuTriangle>(buffers_.fan, counts.needed.triangles);
  }
  std::vector<GpuVisible> visible() const {
    return read<GpuVisible>(buffers_.visible, counts.needed.visible);
  }
  /// [slice][port, starboard][probe]
  std::vector<float> sides() const {
    return read<float>(buffers_.sides, std::size_t{counts.needed.slices} * 2 * slices::side_probes);
  }

 private:
  template <class T>
  std::vector<T> read(const GpuBuffer& buffer, std::size_t count) const {
    return test::read_back<T>(buffers_.gl, buffer, count);
  }

  GpuSlices gpu_;
  PingBuffers buffers_{gpu_.compute().gl()};
};

class GpuSlicesTest : public test::GlContextTest {
 protected:
  static constexpr std::size_t every = 2;
  /// Sees every second slice of a ping of the CPU engine, preset `default`, with both.
  Comparison compare(const std::string& scene_name, const GpuOptions& options);
};

bool has_same_bits(const VisibleSegment& cpu, const GpuVisible& gpu) {
  return cpu.low == gpu.low && cpu.high == gpu.high && cpu.w_at_0 == gpu.w_at_0 &&
         cpu.w_slope == gpu.w_slope && cpu.low_run.slope == gpu.low_slope &&
         cpu.low_run.reach == gpu.low_reach && cpu.high_run.slope == gpu.high_slope &&
         cpu.high_run.reach == gpu.high_reach && cpu.normal_h == gpu.normal_h &&
         cpu.normal_s == gpu.normal_s && cpu.normal_z == gpu.normal_z;
}

std::size_t count_off(const SideProfile& cpu, const float* gpu) {
  std::size_t off = 0;
  for (std::size_t k = 0; k < slices::side_probes; ++k) {
    off += std::abs(cpu[k] - gpu[k]) > 1e-5F * cpu[k] ? 1 : 0;
  }
  return off;
}

Comparison GpuSlicesTest::compare(const std::string& scene_name, const GpuOptions& options) {
  const PingOnCpu ping(scene_name);
  std::vector<const SliceCell*> cells;
  std::vector<GpuSlice> slices;
  for (std::size_t i = 0; i < ping.cells.size(); i += every) {
    const SliceCell* const cell = cells.emplace_back(ping.cells[i]);
    GpuSlice& slice = slices.emplace_back();
    slice.cosine = cell->slice.cosine;
    slice.sine = cell->slice.sine;
    slice.width_rad = cell->slice.width_rad;
    slice.beam = cell->beam;
  }
  const PingOnGpu gpu(*context_, options, ping, 1, slices);
  const std::vector<GpuSlice> seen = gpu.slices();
  Comparison result;
  result.counts = gpu.counts;
  result.slices = cells.size();
  EXPECT_EQ(seen.size(), cells.size());
  const auto triangles = gpu.triangles();
  const auto visible = gpu.visible();
  const auto sides = gpu.sides();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::vector<VisibleSegment>& of_cpu = cells[i]->visible;
    const auto first = visible.begin() + seen[i].first_visible;
    const std::vector<GpuVisible> of_gpu(first, first + seen[i].visible_count);
    result.same_bits += std::ranges::equal(of_cpu, of_gpu, has_same_bits) ? 1 : 0;
    result.differing += differing_share(of_cpu, of_gpu, triangles, ping.of_gpu.fan.tan_limit());
    const float* const of_sides = &sides[2 * i * slices::side_probes];
    result.off_sides +=
        static_cast<double>(count_off(cells[i]->sides.port, of_sides) +
                            count_off(cells[i]->sides.starboard, of_sides + slices::side_probes));
  }
  result.differing /= static_cast<double>(cells.size());
  result.off_sides /= static_cast<double>(cells.size() * 2 * slices::side_probes);
  std::cout << scene_name << ": " << result.same_bits << " of " << result.slices
            << " slices with the same bits, " << result.differing << " of the elevations differ, "
            << result.off_sides << " of the probes\n";
  return result;
}

/// The CPU must render what the shaders cannot count: 1024 slices of a beam, or 65,536 of a fan.
TEST_F(GpuSlicesTest, TooManyFirstSlicesAreARequestError) {
  for (const auto& [beams, slices_per_beam] : {std::pair{4, 1024}, {4096, 16}}) {
    SCOPED_TRACE(beams);
    test::Scene scene = test::make_scene("plane");
    scene.settings.aperture.beam_edges_rad = equal_angle_edges(beams, 1.0);
    GpuPing ping({scene.T_world_sonar, scene.settings}, {}, 1.0F);
    ping.accuracy.slices_per_beam = slices_per_beam;
    GpuSlices gpu(*context_, {});
    PingBuffers buffers(gpu.compute().gl());
    EXPECT_THROW(gpu.find(buffers, {}, ping), RequestError);
  }
}

/// Pieces that begin in the middle of surfaces which touch may see one or the other of them first.
TEST_F(GpuSlicesTest, SeesWhatTheCpuSees) {
  for (const char* scene : {"docking", "b4_manifold_1e5"}) {
    SCOPED_TRACE(scene);
    const Comparison found = compare(scene, {});
    EXPECT_EQ(found.counts.overflows, 0U);
    EXPECT_GT(found.slices, 1000U);
    EXPECT_LE(found.differing, 1e-5);
    EXPECT_LE(found.off_sides, 1e-4);
  }
}

TEST_F(GpuSlicesTest, InOnePieceItSeesTheSameBits) {
  const Comparison found = compare("swell100k", {.group = 1});
  EXPECT_LE(found.differing, 1e-7);
  if (context_->software()) {
    EXPECT_EQ(found.same_bits, found.slices);
  }
}

/// The groups of a GPU. Here the vectors of a group run one after the other, from barrier to barrier.
TEST_F(GpuSlicesTest, InLargeGroupsItSeesTheSame) {
  const Comparison found = compare("swell100k", {.group = 64});
  EXPECT_EQ(found.counts.overflows, 0U);
  EXPECT_LE(found.differing, 1e-5);
  EXPECT_LE(found.off_sides, 1e-4);
}

TEST_F(GpuSlicesTest, SlicesWithTooManySegmentsAreSeenInBands) {
  const Comparison found = compare("swell100k", {.segments = 96});
  EXPECT_EQ(found.counts.longest_slice, 97U) << "more than there was room for";
  EXPECT_EQ(found.counts.overflows, 0U);
  EXPECT_LE(found.differing, 1e-5);
  EXPECT_LE(found.off_sides, 1e-3);
}

/// llvmpipe ends the loops of an invocation after 65,535 rounds and says nothing. One invocation has 100,000
/// triangles here. The CPU must render such a ping.
TEST_F(GpuSlicesTest, LoopsThatTheDriverEndsEarlyAreAnOverflow) {
  test::Scene scene = test::make_scene("swell100k");
  std::vector<double>& edges = scene.settings.aperture.beam_edges_rad;
  edges = {edges.front(), edges.back()};
  const PingOnCpu ping(std::move(scene));
  const PingOnGpu of_one(*context_, {.group = 1}, ping, 1);
  if (context_->software()) {
    EXPECT_GT(of_one.counts.overflows, 0U);
  } else {
    EXPECT_EQ(of_one.counts.overflows, 0U);
  }
}

/// Share of the fan that both engines see in the same slices.
double same_slices(const PingOnCpu& ping, const std::vector<GpuSlice>& on_gpu) {
  std::vector<std::vector<const GpuSlice*>> of_beam(static_cast<std::size_t>(ping.of_gpu.fan.beam_count()));
  for (const GpuSlice& slice : on_gpu) {
    if ((slice.state & records::is_divided) == 0) {
      of_beam[static_cast<std::size_t>(slice.beam)].push_back(&slice);
    }
  }
  double same_rad = 0;
  for (const SliceCell* cell : ping.cells) {
    const double middle_rad =
        (ping.of_gpu.fan.edge_rad(cell->beam) + ping.of_gpu.fan.edge_rad(cell->beam + 1)) / 2;
    for (const GpuSlice* slice : of_beam[static_cast<std::size_t>(cell->beam)]) {
      const double off_rad =
          std::abs(middle_rad + static_cast<double>(slice->offset_rad) - cell->slice.azimuth_rad);
      const double width_rad = static_cast<double>(cell->slice.width_rad);
      const bool same_width =
          std::abs(slice->width_rad - cell->slice.width_rad) < 1e-2F * cell->slice.width_rad;
      same_rad += off_rad < 1e-2 * width_rad && same_width ? width_rad : 0.0;
    }
  }
  return same_rad / (ping.of_gpu.fan.edge_rad(0) - ping.of_gpu.fan.edge_rad(ping.of_gpu.fan.beam_count()));
}

/// Largest difference between the width of a beam and its slices, as a share.
double worst_gap(const Fan& fan, const std::vector<GpuSlice>& slices) {
  std::vector<double> left(static_cast<std::size_t>(fan.beam_count()), 1.0);
  for (const GpuSlice& slice : slices) {
    const double width_rad = fan.edge_rad(slice.beam) - fan.edge_rad(slice.beam + 1);
    left[static_cast<std::size_t>(slice.beam)] -=
        (slice.state & records::is_divided) == 0 ? static_cast<double>(slice.width_rad) / width_rad : 0.0;
  }
  double worst = 0;
  for (const double gap : left) {
    worst = std::max(worst, std::abs(gap));
  }
  return worst;
}

/// A probe more or less decides where few probes receive an echo, as from the pipes: rounding divides others.
TEST_F(GpuSlicesTest, DividesTheSlicesThatTheCpuDivides) {
  struct Case {
    const char* scene;
    int group = 0;
  };
  for (const auto& [scene, group] :
       {Case{"docking"}, Case{"b7_pipes"}, Case{"b5_tank"}, Case{"b5_tank", 64}, Case{"b3_cluster"}}) {
    SCOPED_TRACE(scene);
    const PingOnCpu ping(scene);
    const PingOnGpu gpu(*context_, {.group = group}, ping, GpuSlices::most_rounds);
    const std::vector<GpuSlice> slices = gpu.slices();
    const double same = same_slices(ping, slices);
    const auto kept = std::ranges::count_if(
        slices, [](const GpuSlice& slice) { return (slice.state & records::is_divided) == 0; });
    std::cout << scene << ": " << kept << " slices for " << ping.cells.size() << ", " << same
              << " of the fan in the same ones, gap " << worst_gap(ping.of_gpu.fan, slices) << "\n";
    EXPECT_EQ(gpu.counts.overflows, 0U);
    EXPECT_GT(same, 0.95);
    EXPECT_LT(worst_gap(ping.of_gpu.fan, slices), 1e-5);
  }
}

}  // namespace
}  // namespace sonard::render
