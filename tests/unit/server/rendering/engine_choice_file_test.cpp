// SPDX-License-Identifier: Apache-2.0
#include "server/rendering/engine_choice_file.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace sonard::server {
namespace {

using render::EngineKind;

class EngineChoiceFileTest : public ::testing::Test {
 protected:
  std::string content() const {
    std::ifstream head(path_);
    return {std::istreambuf_iterator<char>(head), {}};
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "cache/sonard/engine_choices";
  EngineChoiceFile file_{path_};
};

TEST_F(EngineChoiceFileTest, KnowsWhatWasKeptOfTheSameSituationOnly) {
  EXPECT_FALSE(file_.find("tank").has_value());
  file_.keep("tank", {EngineKind::gpu, "gpu 3 ms"});
  file_.keep("pier", {EngineKind::cpu, "cpu 5 ms"});
  file_.keep("tank", {EngineKind::cpu, "cpu 2 ms,\tgpu\n3 ms"});
  const auto tank = file_.find("tank"), pier = file_.find("pier");
  ASSERT_TRUE(tank && pier);
  EXPECT_EQ(tank->taken, EngineKind::cpu);
  EXPECT_EQ(tank->measured, "cpu 2 ms, gpu 3 ms");
  EXPECT_EQ(pier->taken, EngineKind::cpu);
  EXPECT_FALSE(file_.find("tan").has_value());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path_.parent_path()), {}), 1)
      << "a temporary file was left";
}

TEST_F(EngineChoiceFileTest, TakesADamagedFileForNothingKnown) {
  std::filesystem::create_directories(path_.parent_path());
  std::ofstream(path_) << "no tabs\na\tb\ntank\tauto\tx\npier\tgpu\t1 ms\n\xff\xfe\0";
  EXPECT_FALSE(file_.find("a").has_value());
  EXPECT_FALSE(file_.find("tank").has_value());
  ASSERT_TRUE(file_.find("pier").has_value());
  EXPECT_EQ(file_.find("pier")->taken, EngineKind::gpu);
}

TEST_F(EngineChoiceFileTest, ForgetsTheOldestOfMany) {
  for (int i = 0; i < 70; ++i) {
    file_.keep("world " + std::to_string(i), {EngineKind::cpu, "1 ms"});
  }
  EXPECT_FALSE(file_.find("world 5").has_value());
  EXPECT_TRUE(file_.find("world 6").has_value());
  EXPECT_TRUE(file_.find("world 69").has_value());
}

TEST_F(EngineChoiceFileTest, IsDoneWithoutWhereNothingCanBeWritten) {
  const EngineChoiceFile nowhere("/proc/sonard/engine_choices");
  nowhere.keep("tank", {EngineKind::gpu, "1 ms"});
  EXPECT_FALSE(nowhere.find("tank").has_value());
}

TEST(EngineChoiceSituation, ChangesWithWhatDecides) {
  render::RendererOptions options;
  render::World world;
  render::HeadRequest ping;
  ping.request.settings.aperture.beam_edges_rad = render::equal_angle_edges(64, 1.0);
  const std::string before = situation_of(options, world, std::vector{ping});
  EXPECT_EQ(situation_of(options, world, std::vector{ping}), before);
  ping.request.T_world_sonar.position_m.x = 3;
  EXPECT_EQ(situation_of(options, world, std::vector{ping}), before) << "the place of the sonar does not";
  ping.request.settings.sampling.preset = render::Sampling::Preset::fast;
  const std::string fast = situation_of(options, world, std::vector{ping});
  EXPECT_NE(fast, before);
  options.gpu.device = "1";
  EXPECT_NE(situation_of(options, world, std::vector{ping}), fast);
  EXPECT_EQ(before.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace sonard::server
