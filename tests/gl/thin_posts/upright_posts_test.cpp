// SPDX-License-Identifier: Apache-2.0
// An upright post is neither missed nor fades as it moves between the samples of the fan.
#include "tests/gl/thin_posts/thin_posts.hpp"

namespace sonard::test {
namespace {

using Preset = render::Sampling::Preset;

class UprightPosts : public EngineTest {};
INSTANTIATE_TEST_SUITE_P(Engines, UprightPosts, all_engines(), engine_name);

TEST_P(UprightPosts, AreAtFullScaleInAllPings) {
  expect_full_scale(thin_posts(0, 0, 0), GetParam(), Preset::normal, 0.01);
  expect_full_scale(thin_posts(32, 0, 0), GetParam(), Preset::normal, 0.05);
}

}  // namespace
}  // namespace sonard::test
