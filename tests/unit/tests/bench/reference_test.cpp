// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/reference.hpp"

#include <unistd.h>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/bench/plane_quadrature.hpp"

namespace sonard::bench {
namespace {

namespace fs = std::filesystem;

/// A NumPy file of version 1.0, written from the format's description: magic, version, length of the header,
/// header padded to a multiple of 64, data.
std::string npy(std::string header, const std::vector<float>& values) {
  while ((10 + header.size() + 1) % 64 != 0) {
    header += ' ';
  }
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  std::string data(4 * values.size(), '\0');
  std::memcpy(data.data(), values.data(), data.size());
  return bytes + data;
}

const char* const two_by_three = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";

class ReferenceFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("sonard_reference_test_" +
               std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  fs::path folder_;
};

test::Scene small_scene() {
  test::Scene scene;
  scene.name = "small";
  scene.settings.aperture.beam_edges_rad = {0.1, 0.0, -0.1};
  scene.settings.range = {3, 1.0, 0, false};
  return scene;
}

TEST_F(ReferenceFiles, AreReadBeamByBeam) {
  const render::EchoImage image = read_npy(write("a.npy", npy(two_by_three, {1, 2, 3, 4, 5, 6.5F})));
  EXPECT_EQ(image.beams, 2);
  EXPECT_EQ(image.bins, 3);
  EXPECT_EQ(image.at(0, 2), 3);
  EXPECT_EQ(image.at(1, 0), 4);
  EXPECT_EQ(image.at(1, 2), 6.5F);
}

TEST_F(ReferenceFiles, OtherLayoutsAreRefused) {
  EXPECT_THROW(read_npy(folder_ / "missing.npy"), std::runtime_error);
  EXPECT_THROW(read_npy(write("a.npy", "P5 2 3 255 not numpy at all")), std::runtime_error);
  EXPECT_THROW(read_npy(write("b.npy", npy(two_by_three, {1, 2, 3, 4, 5}))), std::runtime_error);
  for (const char* header : {"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }",
                             "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }",
                             "{'descr': '<f4', 'fortran_order': False, 'shape': (6,), }"}) {
    EXPECT_THROW(read_npy(write("c.npy", npy(header, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}))),
                 std::runtime_error)
        << header;
  }
}

TEST_F(ReferenceFiles, AreFoundByTheSceneName) {
  EXPECT_FALSE(find_reference(small_scene(), folder_));
  write("small.npy", npy(two_by_three, {1, 2, 3, 4, 5, 6}));
  write("small.json", R"({"scene": "small", "error_rms": 0.0008, "error_max": 0.01})");
  const auto reference = find_reference(small_scene(), folder_);
  ASSERT_TRUE(reference);
  EXPECT_FALSE(reference->closed_form);
  EXPECT_EQ(reference->image.at(1, 1), 5);
  EXPECT_EQ(reference->error_rms, 0.0008);
}

TEST_F(ReferenceFiles, OfAnotherSizeAreStale) {
  write("small.npy", npy("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }", {1, 2, 3, 4, 5, 6}));
  EXPECT_THROW(find_reference(small_scene(), folder_), std::runtime_error);
}

// docs/physics.md 3.2, T3: E_k = (h^2 / 4) (r_k^-4 - r_{k+1}^-4) per unit azimuth, from h / sin(th_max) on.
TEST(PlaneReference, IsTheSeabedOfTheClosedForm) {
  test::Scene scene = test::make_scene("b2_seabed_5m");
  scene.settings.aperture.beam_edges_rad = {0.01, 0.0, -0.03};
  const render::EchoImage image = plane_image(scene);
  for (const int line : {600, 700, 999}) {
    const double r1 = line * 0.05, r2 = r1 + 0.05;
    const double per_radian = 25.0 / 4 * (std::pow(r1, -4) - std::pow(r2, -4)) / std::numbers::pi;
    EXPECT_NEAR(static_cast<double>(image.at(0, line)) / (0.01 * per_radian), 1, 1e-5);
    EXPECT_NEAR(static_cast<double>(image.at(1, line)) / (0.03 * per_radian), 1, 1e-5);
  }
  EXPECT_EQ(image.at(0, 500), 0);  // 25 m: above the lowest ray, which meets the bed at 28.8 m
}

// Compared with the midpoint rule, with so many nodes that kinks do not matter: a wall at the side of the
// fan, whose first echo sweeps over 35 lines within a beam, an oblique slope, and the benchmark's own plane
// at the edge of its fan.
TEST(PlaneReference, QuadratureFindsTheKinks) {
  const double limit = 10 * std::numbers::pi / 180, tilt = 20 * std::numbers::pi / 180;
  const test::PlaneTruth wall{10, 1, 0, 0, limit};
  const test::PlaneTruth slope{9 * 0.8, 0.8, 0.36, -0.48, limit};
  const test::PlaneTruth bed{4, std::sin(tilt), 0, -std::cos(tilt), limit};
  struct Place {
    test::PlaneTruth plane;
    double psi_from, psi_to, r1;
  };
  int compared = 0;
  for (const Place& place :
       {Place{wall, 1.039, 1.047, 19.7}, Place{wall, 0.0, 0.008, 10.0}, Place{wall, -0.5, -0.492, 11.37},
        Place{slope, 0.1, 0.108, 8.2}, Place{slope, -0.9, -0.892, 10.0}, Place{bed, 1.039, 1.047, 11.0},
        Place{bed, 0.5, 0.508, 8.9}}) {
    for (int line = 0; line < 20; ++line) {
      const double r1 = place.r1 + 0.02 * line;
      const double truth = place.plane.beam(place.psi_from, place.psi_to, r1, r1 + 0.02, 20'000);
      const double quick = plane_beam_echo(place.plane, place.psi_from, place.psi_to, r1, r1 + 0.02);
      EXPECT_NEAR(quick, truth, 2e-6 * truth + 1e-12) << place.psi_from << " " << r1;
      compared += truth > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 70);
}

}  // namespace
}  // namespace sonard::bench
