// SPDX-License-Identifier: Apache-2.0
// The stored images: their format, and whether they still belong to the present scenes.
#include "tests/oracle/reference.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <span>

#include <gtest/gtest.h>

#include "tests/oracle/scene_hash.hpp"
#include "tests/oracle/sha256.hpp"
#include "tests/oracle/slice_integrator.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/unit/tests/oracle/small_worlds.hpp"

namespace sonard::oracle {

namespace {

const std::filesystem::path stored = SONARD_SOURCE_DIR "/tests/data/oracle";

std::string sha256(const std::string& text) {
  Sha256 hash;
  hash.add(std::as_bytes(std::span(text)));
  return hash.hex_digest();
}

TEST(OracleSha256, ExamplesOfTheStandard) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(OracleSceneHash, ChangesWithWhatIsHeardAndWithNothingElse) {
  const render::World world = world_of({quad({10, 0, 0}, {0, 1, 0}, {0, 0, 1})});
  const render::Pose pose;
  const render::SonarSettings settings = ping(4, 0.2, 0.2, 10, 10);
  const std::string hash = scene_hash(world, pose, settings);
  std::set<std::string> hashes{hash};

  render::World renamed = world;
  renamed.name = renamed.bodies[0].name = renamed.bodies[0].parts[0].material.name = "other";
  render::SonarSettings resampled = settings;
  resampled.sampling.rows = 17;
  resampled.physical.noise.on = !resampled.physical.noise.on;
  render::Pose negated = pose;
  negated.orientation = -negated.orientation;
  EXPECT_EQ(scene_hash(renamed, negated, resampled), hash);

  hashes.insert(scene_hash(world_of({quad({10.001, 0, 0}, {0, 1, 0}, {0, 0, 1})}), pose, settings));
  render::World darker = world;
  darker.bodies[0].parts[0].material.lambert_mu *= 0.999;
  hashes.insert(scene_hash(darker, pose, settings));
  render::World moved = world;
  moved.bodies[0].T_world_body.position_m.y = 1e-3;
  hashes.insert(scene_hash(moved, pose, settings));
  render::Pose lower = pose;
  lower.position_m.z = -1e-3;
  hashes.insert(scene_hash(world, lower, settings));
  render::SonarSettings longer = settings;
  longer.range.step_m *= 1.001;
  hashes.insert(scene_hash(world, pose, longer));
  render::SonarSettings paper = settings;
  paper.model = render::Model::paper;
  hashes.insert(scene_hash(world, pose, paper));
  EXPECT_EQ(hashes.size(), 7U);
}

TEST(OracleReference, IsReadAsItWasWritten) {
  Reference written;
  written.scene = "reference_test";
  written.scene_sha256 = sha256("scene");
  written.slices = 12345;
  written.error = {1.5e-5, 2e-3};
  written.ray_check_stride = 8;
  written.ray_check = {1e-4, 0.02};
  written.command = "sonard_oracle reference_test";
  written.beams = 3;
  written.lines = 2;
  written.echo = {0.0F, 1.0F, 2.5e-9F, -0.0F, 1e-38F, 3.0F};
  const std::filesystem::path folder = testing::TempDir();
  write_reference(folder, written);
  const Reference read = read_reference(folder, written.scene);
  EXPECT_EQ(read.scene_sha256, written.scene_sha256);
  EXPECT_EQ(read.slices, written.slices);
  EXPECT_DOUBLE_EQ(read.error.rms, written.error.rms);
  EXPECT_DOUBLE_EQ(read.ray_check.max, written.ray_check.max);
  EXPECT_EQ(read.beams, 3);
  EXPECT_EQ(read.echo, written.echo);

  std::ifstream file(folder / "reference_test.npy", std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  EXPECT_EQ((bytes.size() - written.echo.size() * sizeof(float)) % 64, 0U);
  EXPECT_NE(bytes.find("'descr': '<f4', 'fortran_order': False, 'shape': (3, 2)"), std::string::npos);

  bytes.back() ^= 1;
  std::ofstream(folder / "reference_test.npy", std::ios::binary) << bytes;
  EXPECT_THROW(read_reference(folder, written.scene), std::runtime_error);
  EXPECT_THROW(read_reference(folder, "no_such_scene"), std::runtime_error);
}

/// The chosen beams of the reference as an image, for comparison.
EchoTruth as_truth(const Reference& reference, const std::vector<int>& beams) {
  EchoTruth truth;
  truth.beams = reference.beams;
  truth.lines = reference.lines;
  truth.echo.assign(reference.echo.size(), 0.0);
  truth.error = truth.echo;
  for (const int beam : beams) {
    const auto begin = static_cast<std::ptrdiff_t>(beam) * truth.lines;
    std::copy_n(reference.echo.begin() + begin, truth.lines, truth.echo.begin() + begin);
  }
  return truth;
}

class StoredReference : public testing::TestWithParam<const char*> {};

TEST_P(StoredReference, BelongsToTheSceneAsBuiltToday) {
  const Reference reference = read_reference(stored, GetParam());
  const test::Scene scene = test::make_scene(GetParam());
  ASSERT_EQ(scene_hash(scene.world, scene.T_world_sonar, scene.settings), reference.scene_sha256)
      << "the reference is stale; run: " << reference.command;
  EXPECT_LT(reference.error.rms, 1e-4);
  // Rays, which share only the echo law with the slices, agreed within their errors.
  EXPECT_LT(reference.ray_check.rms, reference.ray_error.rms + reference.error.rms);
  EXPECT_GT(reference.ray_check_stride, 0);

  const EchoLaw law(scene.settings);
  SliceOptions coarse;
  coarse.error_rms = 1e-3;
  coarse.error_max = 0.1;
  coarse.beams = {0};
  if (law.beams() == 256) {
    coarse.beams = {3, 100, 131, 250};
  }
  const EchoTruth today = integrate_slices(Facets(scene.world, scene.T_world_sonar, law), law, coarse);
  const EchoTruth truth = as_truth(reference, coarse.beams);
  EXPECT_GT(total(truth), 0);
  EXPECT_LT(difference(today, truth).rms, estimated_error(today).rms + reference.error.rms);
}

INSTANTIATE_TEST_SUITE_P(Oracle, StoredReference,
                         testing::Values("flat100k", "swell100k", "ripple100k", "swell1m", "msis_swell",
                                         "msis_ripple", "b3_cluster", "b4_manifold_1e5", "b5_tank",
                                         "b7_pipes", "docking"),
                         [](const auto& scene) { return std::string(scene.param); });

}  // namespace

}  // namespace sonard::oracle
