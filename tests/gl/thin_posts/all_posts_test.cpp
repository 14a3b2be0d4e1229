// SPDX-License-Identifier: Apache-2.0
// Flat and round posts that stand, lean or lie, in open water and on a bed, with all presets.
#include <string>
#include <tuple>
#include <utility>

#include "tests/gl/thin_posts/thin_posts.hpp"
#include "tests/support/degree.hpp"

namespace sonard::test {
namespace {

using render::EngineKind;
using Preset = render::Sampling::Preset;

/// The azimuths of upright edges are known exactly. Other errors come from the least width of slices
/// (most_divisions), which is smaller for a post alone in the water: a round post has the echo of few of its
/// facets, and slices cut the end of a leaning one.
double tolerance(const ThinPost& post, Preset preset) {
  const bool is_exact = post.facets == 0 && post.lean_rad == 0;
  return preset == Preset::fast ? 0.4 : post.bed_m == 0 || is_exact ? 0.05 : 0.3;
}

class AllPosts : public ::testing::TestWithParam<std::tuple<EngineKind, Preset>> {
 protected:
  void SetUp() override {
    if (std::get<EngineKind>(GetParam()) == EngineKind::gpu) {
      require_gl();
    }
  }

  static void expect_full_scale_at(double bed_m) {
    const auto [engine, preset] = GetParam();
    for (const auto& [facets, lean_deg] : {std::pair{0, 0}, std::pair{16, 0}, std::pair{32, 0},
                                           std::pair{16, 5}, std::pair{0, 15}, std::pair{16, 90}}) {
      for (const ThinPost& post : thin_posts(facets, lean_deg * degree, bed_m)) {
        expect_full_scale({post}, engine, preset, tolerance(post, preset));
      }
    }
  }
};

std::string case_name(const ::testing::TestParamInfo<AllPosts::ParamType>& one) {
  const auto [engine, preset] = one.param;
  return std::string(render::name_of(engine)) + (preset == Preset::fast     ? "_fast"
                                                 : preset == Preset::normal ? "_default"
                                                                            : "_reference");
}

INSTANTIATE_TEST_SUITE_P(Engines, AllPosts,
                         ::testing::Combine(all_engines(), ::testing::Values(Preset::fast, Preset::normal,
                                                                             Preset::reference)),
                         case_name);

TEST_P(AllPosts, AreAtFullScaleInOpenWater) {
  expect_full_scale_at(0);
}

TEST_P(AllPosts, AreAtFullScaleOnABed) {
  expect_full_scale_at(3);
}

}  // namespace
}  // namespace sonard::test
