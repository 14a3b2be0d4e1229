// SPDX-License-Identifier: Apache-2.0
// S6 to S10 and S15 to S17 of docs/physics.md 4.3: poses, ranges, sizes, apertures, water, materials, gain.
#include <functional>
#include <limits>

#include "protocol/pose/transform.hpp"
#include "renderer/scene/materials.hpp"
#include "tests/gl/stability/stability_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

SONARD_STABILITY_SUITE(Settings);

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

/// A wall across x that fills every fan below a half turn.
World wall(double x_m, double mu = full_mu) {
  Body body = make_body("wall", make_quad({0, -500, -500}, {0, 1000, 0}, {0, 0, 1000}), mu);
  body.T_world_body.position_m.x = x_m;
  return make_world({body});
}

// pose::normalize() refuses or scales incoming poses; the renderer checks its poses again.
TEST_P(Settings, S6PosesAreRefusedOrScaledAndTheSignOfAQuaternionDoesNotMatter) {
  using pose::TransformFault;
  const auto fault = [](pose::Transform transform) { return pose::normalize(transform); };
  EXPECT_EQ(fault({{nan, 0, 0}, {}}), TransformFault::position_not_finite);
  EXPECT_EQ(fault({{0, -inf, 0}, {}}), TransformFault::position_not_finite);
  EXPECT_EQ(fault({{}, {nan, 0, 0, 0}}), TransformFault::orientation_not_finite);
  EXPECT_EQ(fault({{}, {1, 0, inf, 0}}), TransformFault::orientation_not_finite);
  for (const double length : {0.0, 1e-20, 1e20, 1e-200, 1e200}) {
    EXPECT_EQ(fault({{}, {length, 0, 0, 0}}), TransformFault::orientation_norm) << length;
  }

  SonarRenderer renderer(small_harbour(), options());
  PingRequest request = quiet_request();
  const glm::dquat q = glm::angleAxis(0.5, glm::normalize(glm::dvec3(0.1, 1, 0.2)));
  request.T_world_sonar.orientation = q;
  const EchoImage image = renderer.render_echo(request);
  EXPECT_GT(sum(image), 0);
  for (const double length : {0.01, 0.7, 1.5, 500.0}) {
    pose::Transform given{{0, 0, 3}, {length * q.w, length * q.x, length * q.y, length * q.z}};
    ASSERT_EQ(pose::normalize(given), TransformFault::none) << length;
    const pose::Quat& scaled = given.orientation;
    request.T_world_sonar.orientation = {scaled.w, scaled.x, scaled.y, scaled.z};
    EXPECT_LE(different_share(image, renderer.render_echo(request), 1e-5), silhouette_share) << length;
  }
  request.T_world_sonar.orientation = -q;
  EXPECT_EQ(renderer.render_echo(request).intensity, image.intensity);

  const glm::dquat one{1, 0, 0, 0};
  for (const Pose& bad :
       {Pose{{nan, 0, 0}, one}, Pose{{0, 0, inf}, one}, Pose{{}, {0, 0, 0, 0}}, Pose{{}, {1e-20, 0, 0, 0}},
        Pose{{}, {1e20, 0, 0, 0}}, Pose{{}, {nan, 0, 0, 0}}, Pose{{}, {1, inf, 0, 0}}}) {
    request.T_world_sonar = bad;
    EXPECT_THROW(renderer.render_echo(request), RequestError);
    EXPECT_THROW(renderer.render_ping(request), RequestError);
    EXPECT_THROW(renderer.set_body_pose("ball", bad), RequestError);
  }
  request.T_world_sonar = {{0, 0, 3}, q};
  EXPECT_EQ(renderer.render_echo(request).intensity, image.intensity) << "refused poses leave nothing behind";
}

TEST_P(Settings, S7RangesAreRefusedOrGiveAValidImage) {
  SonarRenderer renderer(wall(5), options());
  const auto with = [](int lines, double step_m, int compression_log2 = 0) {
    PingRequest request = level_request();
    request.settings.range = {lines, step_m, compression_log2, false};
    return request;
  };
  for (const auto& [lines, step_m] : std::vector<std::pair<int, double>>{{0, 0.02},
                                                                         {-1, 0.02},
                                                                         {65536, 1e-3},
                                                                         {100, 0.0},
                                                                         {100, -0.02},
                                                                         {100, nan},
                                                                         {100, inf},
                                                                         {100, 1e-7},
                                                                         {100, 1e-300},
                                                                         {65535, 10.0}}) {
    EXPECT_THROW(renderer.render_echo(with(lines, step_m)), RequestError) << lines << " x " << step_m;
  }
  EXPECT_THROW(renderer.render_echo(with(100, 0.02, 5)), RequestError);
  EXPECT_THROW(renderer.render_echo(with(100, 0.02, -1)), RequestError);

  // A millimetre of range, and lines of a micrometre. With at most 65535 lines, no request resolves more than
  // float does at the wall.
  for (const auto& [lines, step_m] :
       std::vector<std::pair<int, double>>{{10, 1e-4}, {65535, 1e-6}, {1, 1e-6}}) {
    const EchoImage image = renderer.render_echo(with(lines, step_m));
    EXPECT_EQ(image.bins, lines);
    EXPECT_TRUE(is_sane(image));
    EXPECT_EQ(sum(image), 0) << "the wall is beyond " << lines << " x " << step_m;
  }
  // The wall in the first line, which begins at range 0, and in ten kilometres of range.
  for (const auto& [lines, step_m] :
       std::vector<std::pair<int, double>>{{1, 1e4}, {1000, 10.0}, {10000, 1.0}}) {
    PingRequest request = with(lines, step_m);
    const EchoImage image = renderer.render_echo(request);
    EXPECT_TRUE(is_sane(image));
    EXPECT_GT(sum(image), 0);
    const PingSamples samples = renderer.render_ping(request);
    EXPECT_EQ(samples.u8.size(), image.intensity.size());
  }
  // A surface right in front of the sonar: r^-2 is taken in the middle of the line.
  renderer.set_body_pose("wall", {{0.021, 0, 0}, {1, 0, 0, 0}});
  const EchoImage near = renderer.render_echo(with(100, 0.5));
  EXPECT_TRUE(is_sane(near));
  EXPECT_GT(near.at(32, 0), 0);
}

TEST_P(Settings, S8SmallestImageAndTarget) {
  PingRequest request = level_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(1, 40 * degree);
  request.settings.range = {1, 10.0, 0, false};
  if (request.settings.sampling.preset == Sampling::Preset::grid) {
    request.settings.sampling = Sampling::of_grid(1, 1, 1);
  }
  SonarRenderer renderer(wall(8), options());
  const EchoImage image = renderer.render_echo(request);
  ASSERT_EQ(image.intensity.size(), 1U);
  // The whole fan, as in S19. One sample takes cos phi and solid angle on the axis for all of it, 9 % too
  // much.
  const double limit = request.settings.aperture.elevation_limit_rad();
  const double truth =
      full_mu * 2 * std::sin(20 * degree) * (limit + std::sin(limit) * std::cos(limit)) / 25.0;
  EXPECT_NEAR(static_cast<double>(image.at(0, 0)) / truth, 1.0, 0.1);
  EXPECT_EQ(renderer.render_ping(request).u8.size(), 1U);
}

TEST_P(Settings, S8LargestImage) {
  PingRequest request = level_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(4096, 120 * degree);
  request.settings.range = {16384, 1e-3, 0, false};
  if (request.settings.sampling.preset == Sampling::Preset::grid) {
    request.settings.sampling = Sampling::of_grid(3, 2048, 32);
  }
  SonarRenderer renderer(wall(5), options());
  const EchoImage image = renderer.render_echo(request);
  ASSERT_EQ(image.intensity.size(), 4096U * 16384U);
  EXPECT_TRUE(is_sane(image));
  // First echo of every beam: 5 m over the cosine of its inner edge.
  for (int beam = 0; beam < 4096; beam += 128) {
    const auto b = static_cast<std::size_t>(beam);
    const double inner = std::min(std::abs(request.settings.aperture.beam_edges_rad[b]),
                                  std::abs(request.settings.aperture.beam_edges_rad[b + 1]));
    int k = 0;
    while (k < image.bins && !(image.at(beam, k) > 0)) {
      ++k;
    }
    EXPECT_NEAR(k, std::floor(5 / std::cos(inner) / 1e-3), 2) << beam;
  }
}

TEST_P(Settings, S8NothingAndTooMuchAreRefusedBeforeAllocation) {
  SonarRenderer renderer(wall(5), options());
  const auto refused = [&](const std::function<void(SonarSettings&)>& change) {
    PingRequest request = level_request();
    request.settings.sampling = Sampling::of_grid(3, 128, 128);
    change(request.settings);
    EXPECT_THROW(renderer.render_echo(request), RequestError);
  };
  refused([](SonarSettings& s) { s.aperture.beam_edges_rad.clear(); });
  refused([](SonarSettings& s) { s.aperture.beam_edges_rad = {0.1}; });
  refused([](SonarSettings& s) { s.aperture.beam_edges_rad = equal_angle_edges(4097, 2.0); });
  refused([](SonarSettings& s) { s.range.count = 0; });
  refused([](SonarSettings& s) { s.range.count = 1 << 30; });
  refused([](SonarSettings& s) { s.sampling.views = 0; });
  refused([](SonarSettings& s) { s.sampling.columns_per_view = 0; });
  refused([](SonarSettings& s) { s.sampling.rows = 0; });
  refused([](SonarSettings& s) { s.sampling.rows = 1 << 30; });
  // Each number for itself is allowed; together they are 17 billion samples.
  refused([](SonarSettings& s) { s.sampling = Sampling::of_grid(64, 16384, 16384); });
  EXPECT_GT(sum(renderer.render_echo(level_request())), 0) << "and then goes on";
}

// A bed at depth h below a level fan of half height theta_m: its echo per azimuth is mu h^2 / 4 times
// (sin(theta_m) / h)^4 - R^-4 up to range R (docs/physics.md 3.2, T3), equal at every azimuth.
TEST_P(Settings, S9EveryFanHearsTheBedBelow) {
  const TriangleMesh bed = make_quad({-100, -100, 0}, {200, 0, 0}, {0, 200, 0});
  SonarRenderer renderer(make_world({make_body("bed", bed, full_mu)}), options());
  for (const double width_deg : {0.01, 120.0, 179.0, 180.0, 360.0}) {
    for (const double height_deg : {0.01, 20.0, 120.0, 170.0}) {
      PingRequest request = level_request();
      constexpr int beams = 12;
      const double depth_m = height_deg < 1 ? 1e-3 : 1.0;
      const double limit = height_deg / 2 * degree;
      request.T_world_sonar.position_m.z = depth_m;
      request.settings.aperture.beam_edges_rad = equal_angle_edges(beams, width_deg * degree);
      request.settings.aperture.vertical_beamwidth_rad = 2 * limit;
      if (request.settings.sampling.preset == Sampling::Preset::grid) {
        request.settings.sampling = sampling(128, 512);
      }
      const EchoImage image = renderer.render_echo(request);
      ASSERT_TRUE(is_sane(image));
      const double truth = width_deg * degree / beams * full_mu * depth_m * depth_m / 4 *
                           (std::pow(std::sin(limit) / depth_m, 4) - std::pow(16.0, -4));
      for (int beam = 0; beam < beams; ++beam) {
        EXPECT_NEAR(beam_sum(image, beam) / truth, 1.0, 0.01)
            << width_deg << " x " << height_deg << " deg, beam " << beam;
      }
    }
  }
}

// After half a turn, the image of a full circle is shifted by half the beams: the view ahead in one image
// lies across the seam in the other.
TEST_P(Settings, S9FullCircleHasNoSeam) {
  SonarRenderer renderer(small_harbour(), options());
  constexpr int beams = 72;
  PingRequest request = quiet_request();
  request.T_world_sonar.orientation = {1, 0, 0, 0};
  request.T_world_sonar.position_m.z = 1;
  request.settings.aperture.beam_edges_rad = equal_angle_edges(beams, 360 * degree);
  request.settings.sampling.columns_per_view *= 2;
  const EchoImage ahead = renderer.render_echo(request);
  request.T_world_sonar.orientation = glm::angleAxis(180 * degree, glm::dvec3(0, 0, 1));
  EchoImage behind = renderer.render_echo(request);
  std::rotate(behind.intensity.begin(),
              behind.intensity.begin() + static_cast<std::ptrdiff_t>(beams / 2) * behind.bins,
              behind.intensity.end());
  EXPECT_GT(sum(ahead), 0);
  // Edges of the crate fall differently into slices, within the preset's 1 %.
  const bool slices = GetParam() == Way::cpu_slices;
  EXPECT_NEAR(sum(behind) / sum(ahead), 1.0, slices ? 1e-2 : 1e-4);
  EXPECT_LE(different_share(ahead, behind, slices ? 5e-2 : 1e-3), silhouette_share);
}

TEST_P(Settings, S9FansThatCannotBeAreRefused) {
  SonarRenderer renderer(wall(5), options());
  const auto refused = [&](const std::function<void(Aperture&)>& change) {
    PingRequest request = level_request();
    change(request.settings.aperture);
    EXPECT_THROW(renderer.render_echo(request), RequestError);
  };
  refused([](Aperture& a) { a.beam_edges_rad = equal_angle_edges(8, 361 * degree); });
  refused([](Aperture& a) { a.beam_edges_rad = equal_angle_edges(8, 0); });
  refused([](Aperture& a) { a.beam_edges_rad = {-0.1, 0.1}; });
  refused([](Aperture& a) { a.beam_edges_rad = {nan, 0.0}; });
  // Azimuths lie in (-pi, pi]: a fan across half a turn needs a full circle or a turned sonar.
  refused([](Aperture& a) { a.beam_edges_rad = {182 * degree, 178 * degree}; });
  for (const double height_deg : {0.0, -1.0, 180.0, 360.0, nan}) {
    refused([&](Aperture& a) { a.vertical_beamwidth_rad = height_deg * degree; });
  }
}

// A scanning head is one beam whose bearing turns: 6400 units a turn, as integers.
TEST_P(Settings, S10ScanAcrossHalfATurnHasNoDuplicateAndNoGap) {
  World world = make_world({make_body("ball", make_sphere(0.3F, 32), full_mu)});
  world.bodies[0].T_world_body.position_m = {-6, 0, 0};  // at bearing 180 degrees
  SonarRenderer renderer(world, options());
  PingRequest request = level_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(1, 3 * degree);
  request.settings.aperture.vertical_beamwidth_rad = 35 * degree;
  request.settings.range = {500, 0.02, 0, false};
  if (request.settings.sampling.preset == Sampling::Preset::grid) {
    request.settings.sampling = Sampling::of_grid(1, 64, 256);
  }
  constexpr int units_per_turn = 6400;
  const auto ping_at = [&](int encoder) {
    request.T_world_sonar.orientation =
        glm::angleAxis(2 * std::numbers::pi * encoder / units_per_turn, glm::dvec3(0, 0, 1));
    return renderer.render_echo(request);
  };
  // 3199, 3200 = -3200, -3199: both names of a bearing give one image, and the scan is symmetric about it.
  const auto wrapped = [](int encoder) {
    return encoder > units_per_turn / 2 ? encoder - units_per_turn : encoder;
  };
  constexpr int half_sector = 96;
  constexpr int step = 8;
  std::vector<EchoImage> scan;
  for (int offset = -half_sector; offset <= half_sector; offset += step) {
    scan.push_back(ping_at(wrapped(units_per_turn / 2 + offset)));
    EXPECT_LE(different_share(scan.back(), ping_at(units_per_turn / 2 + offset), 1e-4), 2e-3) << offset;
  }
  for (std::size_t i = 0; i < scan.size(); ++i) {
    EXPECT_NEAR(sum(scan[i]), sum(scan[scan.size() - 1 - i]), 0.03 * sum(scan[scan.size() / 2])) << i;
  }
  // The ball is 5.7 degrees wide: it echoes within 4.4 degrees of 180, or 78 units, and nowhere else. Its
  // limb may fall between two slices.
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const int offset = static_cast<int>(i) * step - half_sector;
    if (std::abs(offset) <= 64 || std::abs(offset) >= 78) {
      EXPECT_EQ(sum(scan[i]) > 0, std::abs(offset) < 78) << offset;
    }
  }
  // Backwards: the same pings.
  std::size_t i = scan.size();
  for (int offset = half_sector; offset >= -half_sector; offset -= step) {
    EXPECT_EQ(ping_at(wrapped(units_per_turn / 2 + offset)).intensity, scan[--i].intensity) << offset;
  }
  // Standing still: the same ping.
  EXPECT_EQ(ping_at(wrapped(units_per_turn / 2 + half_sector)).intensity, scan.back().intensity);
}

// Absorption is a factor of each line alone (docs/physics.md 2.1): 10^(-alpha r / 5).
TEST_P(Settings, S15AbsorptionFromNoneToTenDecibelsAMetre) {
  SonarRenderer renderer(wall(5), options());
  PingRequest request = level_request();
  const EchoImage lossless = renderer.render_echo(request);
  for (const double alpha : {1e-6, 0.2, 2.0, 10.0}) {
    request.settings.physical.absorption_db_per_m = alpha;
    const EchoImage image = renderer.render_echo(request);
    ASSERT_TRUE(is_sane(image));
    for (int beam = 0; beam < image.beams; ++beam) {
      for (int k = 0; k < image.bins; ++k) {
        const double expected =
            static_cast<double>(lossless.at(beam, k)) * std::pow(10.0, -alpha * (k + 0.5) * 0.02 / 5);
        ASSERT_NEAR(static_cast<double>(image.at(beam, k)), expected, 1e-5 * expected + 1e-38) << alpha;
      }
    }
  }
  // Over ten kilometres 10 dB/m leave nothing, and no NaN.
  request.settings.range = {1000, 10.0, 0, false};
  for (const double tvg : {0.0, 10.0}) {
    request.settings.physical.tvg.absorption_db_per_m = tvg;
    EXPECT_TRUE(is_sane(renderer.render_echo(request)));
    EXPECT_EQ(renderer.render_ping(request).u8.size(), 64U * 1000U);
  }
}

TEST_P(Settings, S16MaterialsOutsideWhatIsPassive) {
  std::vector<std::string> warnings;
  const auto material = [&](std::optional<double> rho, std::optional<double> mu_db) {
    return make_acoustic_material({"", rho, mu_db}, warnings);
  };
  EXPECT_THROW(material(-0.1, {}), WorldError);
  EXPECT_THROW(material(nan, {}), WorldError);
  EXPECT_THROW(material({}, inf), WorldError);
  EXPECT_EQ(material(0.0, {}).lambert_mu, 0);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(material({}, 10.0).lambert_mu, full_mu);
  EXPECT_EQ(warnings.size(), 1U);
  const AcousticMaterial glaring = material(1e6, {});
  EXPECT_EQ(warnings.size(), 3U) << "the reflectance, and the mu that follows from it";
  EXPECT_EQ(glaring.lambert_mu, full_mu);

  PingRequest request = level_request();
  const auto heard = [&](const AcousticMaterial& m, Model model) {
    World world = wall(5);
    world.bodies[0].parts[0].material = m;
    request.settings.model = model;
    SonarRenderer renderer(world, options());
    const EchoImage image = renderer.render_echo(request);
    EXPECT_TRUE(is_sane(image));
    return image;
  };
  EXPECT_EQ(sum(heard(material(0.0, {}), Model::physical)), 0);
  EXPECT_GT(sum(heard(glaring, Model::physical)), 0);
  // S(0) = 6.1e-6 and S(1) = .9975 (docs/physics.md 1.2). Means are coarse if a line holds a sliver of a
  // slice.
  EXPECT_NEAR(strongest(heard(material(0.0, {}), Model::paper)), 6.1e-6,
              GetParam() == Way::cpu_grid ? 1e-7 : 1e-6);
  EXPECT_NEAR(strongest(heard(glaring, Model::paper)), 0.9975, 1e-4);
}

TEST_P(Settings, S17GainFromNothingToSaturationEverywhere) {
  SonarRenderer renderer(wall(5), options());
  PingRequest request = level_request();
  PhysicalModel& model = request.settings.physical;
  model.near_field_blank_m = 0;
  model.noise.on = true;
  for (const bool sixteen_bit : {false, true}) {
    request.settings.sixteen_bit = sixteen_bit;
    const auto codes = [&](double gain_db) {
      model.gain_db = gain_db;
      const PingSamples samples = renderer.render_ping(request);
      return sixteen_bit ? samples.u16 : std::vector<std::uint16_t>(samples.u8.begin(), samples.u8.end());
    };
    const int full = sixteen_bit ? 65535 : 255;
    const auto loud = codes(400);  // 20 orders of magnitude above full scale
    EXPECT_EQ(*std::min_element(loud.begin(), loud.end()), full);
    const auto silent = codes(-400);
    EXPECT_EQ(*std::max_element(silent.begin(), silent.end()), 0);
    // In between, codes only rise: they do not wrap around.
    std::vector<std::uint16_t> before = silent;
    for (double gain_db = 0; gain_db <= 240; gain_db += 24) {
      const auto now = codes(gain_db);
      for (std::size_t i = 0; i < now.size(); ++i) {
        ASSERT_GE(now[i], before[i]) << gain_db << " dB";
      }
      before = now;
    }
  }
}

}  // namespace
}  // namespace sonard::render
