// SPDX-License-Identifier: Apache-2.0
// A heightmap of 4096 x 4096 pixels from its file to an image.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/bench/machine.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/scenes/terrain.hpp"
#include "tests/support/engine_test.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using namespace sonard::test;

class LargeTerrain : public EngineTest {};

INSTANTIATE_TEST_SUITE_P(Engines, LargeTerrain, all_engines(), engine_name);

/// Writes a 16-bit PGM: rows from the top down, high byte first.
void write_ground(const std::filesystem::path& file, int side_px) {
  const GreyImage picture = ground_picture(side_px);
  std::ofstream stream(file, std::ios::binary);
  stream << "P5\n" << side_px << ' ' << side_px << "\n65535\n";
  const auto side = static_cast<std::size_t>(side_px);
  std::string row(2 * side, '\0');
  for (std::size_t y = side; y-- > 0;) {
    for (std::size_t x = 0; x < side; ++x) {
      const unsigned value = picture.value[y * side + x];
      row[2 * x] = static_cast<char>(value >> 8);
      row[2 * x + 1] = static_cast<char>(value & 0xFFU);
    }
    stream << row;
  }
}

TEST_P(LargeTerrain, TakesLessThanTwoGigabytes) {
  const render::test::TempFolder folder;
  write_ground(folder.path() / "ground.pgm", 4096);
  const auto file = folder.write(
      "world.sdf",
      "<?xml version='1.0'?><sdf version='1.9'><world name='w'><model name='bed'><static>1</static>"
      "<link name='l'><visual name='v'><geometry><heightmap><uri>ground.pgm</uri><size>100 100 12</size>"
      "</heightmap></geometry></visual></link></model></world></sdf>");
  ASSERT_TRUE(bench::reset_peak_memory());
  const World world = load_world(file, {});
  EXPECT_EQ(world.part_count(), 1024U);
  SonarRenderer renderer(world, options());
  PingRequest request = make_terrain_scene("ground", 2).request();
  if (GetParam() == EngineKind::gpu) {
    request.settings.sampling = Sampling::of_grid(2, 256, 256);
  }
  const EchoImage& image = renderer.render_echo(request);
  EXPECT_GT(*std::max_element(image.intensity.begin(), image.intensity.end()), 0.0F);
  EXPECT_LT(bench::peak_memory_mib(), 2000.0);
  std::printf("peak %.0f MiB\n", bench::peak_memory_mib());
}

}  // namespace
}  // namespace sonard::render
