// SPDX-License-Identifier: Apache-2.0
// Rules of exact slices and their binning: each on against off, in worlds with much to skip and in worlds
// with nothing to skip.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/gl/skipping/skipping_worlds.hpp"

namespace sonard::render {
namespace {

using namespace test;

RendererOptions on_cpu() {
  return {EngineKind::cpu, 0};
}

struct Comparison {
  std::uint64_t skipped = 0;      ///< with the rule on
  double worst_of_maximum = 0.0;  ///< largest difference of a bin, over the largest bin
};

/// One ping with the rule on, and with it off.
/// @param off_in_both rules that depend on this one, and would change the image along with it
Comparison compare(SkipRule rule, const World& world, const PingRequest& request,
                   const std::vector<SkipRule>& off_in_both = {}, EngineKind engine = EngineKind::cpu) {
  EXPECT_TRUE(entry_of(rule).bound_unit.starts_with("of the image's maximum"));
  RendererOptions on_options = on_cpu();
  on_options.engine = engine;
  for (const SkipRule other : off_in_both) {
    on_options.skip.turn_off(other);
  }
  RendererOptions off_options = on_options;
  off_options.skip.turn_off(rule);
  SonarRenderer renderer(world, on_options);
  SonarRenderer off(world, off_options);
  const EchoImage& image = renderer.render_echo(request);
  const EchoImage& full = off.render_echo(request);
  EXPECT_EQ(off.last_statistics().skipped.of(rule), 0u);
  EXPECT_EQ(image.intensity.size(), full.intensity.size());
  const float largest = *std::max_element(full.intensity.begin(), full.intensity.end());
  EXPECT_GT(largest, 0.0F) << "there is something to hear";
  Comparison result;
  result.skipped = renderer.last_statistics().skipped.of(rule);
  for (std::size_t i = 0; i < image.intensity.size(); ++i) {
    result.worst_of_maximum = std::max(
        result.worst_of_maximum,
        static_cast<double>(std::abs(image.intensity[i] - full.intensity[i])) / static_cast<double>(largest));
  }
  EXPECT_LE(result.worst_of_maximum, entry_of(rule).bound);
  return result;
}

/// A ball of flat facets. Optional vertex normals equal the normals of the facets.
TriangleMesh faceted_ball(bool with_normals) {
  const TriangleMesh smooth = make_sphere(0.5F, 16);
  TriangleMesh mesh;
  for (std::size_t i = 0; i + 2 < smooth.indices.size(); i += 3) {
    const glm::vec3 a = smooth.positions[smooth.indices[i]];
    const glm::vec3 b = smooth.positions[smooth.indices[i + 1]];
    const glm::vec3 c = smooth.positions[smooth.indices[i + 2]];
    const glm::vec3 across = glm::cross(b - a, c - a);
    for (const glm::vec3& corner : {a, b, c}) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(corner);
      if (with_normals) {
        mesh.normals.push_back(glm::normalize(across));
      }
    }
  }
  return mesh;
}

World ball_alone(TriangleMesh mesh) {
  Body ball = make_body("ball", std::move(mesh));
  ball.T_world_body.position_m = {8, 1, 0.5};
  return make_world({ball});
}

/// A bed that could carry a normal map, finely divided, as one that does is.
World mappable_bed(bool mapped) {
  TriangleMesh mesh;
  constexpr std::uint32_t cells = 40;
  for (std::uint32_t i = 0; i <= cells; ++i) {
    for (std::uint32_t j = 0; j <= cells; ++j) {
      const auto x = static_cast<float>(i) / cells;
      const auto y = static_cast<float>(j) / cells;
      mesh.positions.emplace_back(2 + 18 * x, 40 * y - 20, 0);
      mesh.normals.emplace_back(0, 0, 1);
      mesh.texcoords.emplace_back(x, y);
      mesh.tangents.emplace_back(1, 0, 0, 1);
    }
  }
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t j = 0; j < cells; ++j) {
      const std::uint32_t at = i * (cells + 1) + j;
      const std::uint32_t beyond = at + cells + 1;
      mesh.indices.insert(mesh.indices.end(), {at, beyond, at + 1, at + 1, beyond, beyond + 1});
    }
  }
  World world = make_world({make_body("bed", std::move(mesh), 0.3)});
  if (mapped) {
    NormalMap map{2, 1, {200, 128, 220, 60, 128, 220}};
    world.bodies[0].parts[0].normal_map = std::make_shared<const NormalMap>(std::move(map));
  }
  return world;
}

/// A parallelogram as make_quad's, of cells x cells.
void append_divided_quad(TriangleMesh& mesh, const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b,
                         std::uint32_t cells) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t i = 0; i <= cells; ++i) {
    for (std::uint32_t j = 0; j <= cells; ++j) {
      const auto of = [cells](std::uint32_t n) { return static_cast<float>(n) / static_cast<float>(cells); };
      mesh.positions.push_back(corner + a * of(i) + b * of(j));
    }
  }
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t j = 0; j < cells; ++j) {
      const std::uint32_t at = first + i * (cells + 1) + j;
      const std::uint32_t beyond = at + cells + 1;
      mesh.indices.insert(mesh.indices.end(), {at, beyond, at + 1, at + 1, beyond, beyond + 1});
    }
  }
}

/// bed_and_ball() with a box for the ball, askew; both finely divided.
World divided_bed_and_box() {
  TriangleMesh bed, box;
  append_divided_quad(bed, {2, -20, 0}, {18, 0, 0}, {0, 40, 0}, 40);
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), corner(-0.5F, -0.5F, -0.5F);
  constexpr std::uint32_t cells = 16;  // exact in floats: the faces share their edges
  for (const auto& [a, b] : {std::pair{y, x}, {x, z}, {z, y}}) {
    append_divided_quad(box, corner, a, b, cells);
    append_divided_quad(box, corner + x + y + z, -b, -a, cells);
  }
  Body on_bed = make_body("box", std::move(box));
  on_bed.T_world_body = {{8, 1, 0.5}, glm::angleAxis(0.6, glm::normalize(glm::dvec3(0.2, 0.1, 1)))};
  return make_world({make_body("bed", std::move(bed), 0.3), on_bed});
}

// Balls all around, above and beyond the range; only the one ahead reflects an echo.
TEST(SliceRules, ClustersOutsideTheFanAreCulled) {
  World world = bed_and_ball();
  int outside = 0;
  for (const glm::dvec3& place : {glm::dvec3(-8, 0, 3), glm::dvec3(0, 9, 3), glm::dvec3(6, 0, 9),
                                  glm::dvec3(5, 0, -9), glm::dvec3(18, 1, -6), glm::dvec3(-5, -5, 0)}) {
    Body ball = make_body("ball outside " + std::to_string(outside++), make_sphere(0.5F, 16));
    ball.T_world_body.position_m = place;
    world.bodies.push_back(ball);
  }
  PingRequest request = small_request();
  EXPECT_GE(compare(SkipRule::culled_clusters, world, request).skipped, 6u);
  request.settings.range.count = 100;  // up to 4 m: the ball is beyond too
  request.T_world_sonar.position_m.z = 2;
  EXPECT_GE(compare(SkipRule::culled_clusters, world, request).skipped, 7u);
  // Nothing to cull: all of it is in sight.
  EXPECT_EQ(compare(SkipRule::culled_clusters, ball_alone(make_sphere(0.5F, 16)), small_request()).skipped,
            0u);
}

/// For rules that change the division of slices.
PingRequest exact_request() {
  PingRequest request = small_request();
  request.settings.sampling.preset = Sampling::Preset::reference;
  return request;
}

/// A ping that looks at the box and the bed of divided_bed_and_box() from above and ahead of both.
PingRequest over_the_bed() {
  PingRequest request = exact_request();
  request.T_world_sonar.position_m = {2.5, 0, 3};
  return request;
}

// Half of a box or ball, and stones with either winding on a bed that is seen from above it.
TEST(SliceRules, FacesThatNobodyCanSeeAreDropped) {
  const World ball = ball_alone(make_sphere(0.5F, 16));
  const std::size_t triangles = ball.bodies[0].parts[0].mesh->triangle_count();
  const Comparison half = compare(SkipRule::hidden_faces, ball, exact_request());
  for (const double y_m : {0.0, 0.13, 0.37}) {
    PingRequest request = exact_request();
    request.T_world_sonar.position_m.y = y_m;
    EXPECT_GT(compare(SkipRule::hidden_faces, bed_and_ball(), request).skipped, 0u);
  }
  EXPECT_GT(half.skipped, triangles * 2 / 5);
  EXPECT_LT(half.skipped, triangles * 3 / 5);
  for (const PingRequest& request : {exact_request(), over_the_bed()}) {
    World world = divided_bed_and_box();
    const Comparison outwards = compare(SkipRule::hidden_faces, world, request, {SkipRule::coplanar_facets});
    EXPECT_GT(outwards.skipped, 100u);
    TriangleMesh turned = *world.bodies[1].parts[0].mesh;
    for (std::size_t t = 0; t < turned.indices.size(); t += 3) {
      std::swap(turned.indices[t + 1], turned.indices[t + 2]);
    }
    world.bodies[1].parts[0].mesh = std::make_shared<const TriangleMesh>(std::move(turned));
    EXPECT_EQ(compare(SkipRule::hidden_faces, world, request, {SkipRule::coplanar_facets}).skipped,
              outwards.skipped);
    EXPECT_GE(compare(SkipRule::hidden_faces, world, request).skipped, 6u) << "merged, three of six faces";
  }
}

// From inside a ball all faces are seen from their inner side, and an open bowl shows both.
TEST(SliceRules, FacesThatSomebodyCanSeeStay) {
  World inside = ball_alone(make_sphere(5.0F, 16));
  inside.bodies[0].T_world_body.position_m = small_request().T_world_sonar.position_m;
  EXPECT_EQ(compare(SkipRule::hidden_faces, inside, small_request()).skipped, 0u);
  TriangleMesh bowl = make_sphere(0.5F, 16);
  bowl.indices.resize(bowl.indices.size() / 2);
  EXPECT_EQ(compare(SkipRule::hidden_faces, ball_alone(std::move(bowl)), small_request()).skipped, 0u);
}

// A ball of clean steel on a bed without facets: facets are computed near the ball's nearest point only.
// Facets of rough stone reflect nearly everywhere, and those on a bed seen under 70 degrees nowhere.
TEST(SliceRules, FacetsAreLookedAtNearNormalIncidence) {
  World world = bed_and_ball();
  EXPECT_GT(compare(SkipRule::facet_kernel, world, small_request()).skipped, 100u);
  for (const auto& [m, mu] : {std::pair{0.05, 0.003}, std::pair{0.4, 0.03}}) {
    AcousticMaterial& ball = world.bodies[1].parts[0].material;
    ball.pressure_reflection = 0.9;
    ball.rms_slope = m;
    ball.lambert_mu = mu;
    AcousticMaterial& bed = world.bodies[0].parts[0].material;
    bed.pressure_reflection = 0.4;
    bed.rms_slope = 0.2;
    bed.lambert_mu = 0.006;
    const Comparison found = compare(SkipRule::facet_kernel, world, small_request());
    std::printf("facets, m = %.2f: %llu pieces, %.2e of the maximum\n", m,
                static_cast<unsigned long long>(found.skipped), found.worst_of_maximum);
    EXPECT_GT(found.skipped, 100u);
    EXPECT_GT(found.worst_of_maximum, 0.0) << "the rule leaves something out";
  }
  PingRequest plain = small_request();
  plain.settings.physical.backscatter = PhysicalModel::Backscatter::lambert;
  EXPECT_EQ(compare(SkipRule::facet_kernel, world, plain).skipped, 0u) << "there is nothing to skip";
}

// A scanning sonar looks at one sector only.
TEST(SliceRules, NarrowFanLooksAtItsSectorOnly) {
  World world = bed_and_ball();
  for (int i = 0; i < 20; ++i) {
    Body ball = make_body("ball " + std::to_string(i), make_sphere(0.3F, 16));
    ball.T_world_body.position_m = {6, 0.8 * i + 1.5, 0.5};
    world.bodies.push_back(ball);
  }
  PingRequest request = small_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(1, 0.05);
  EXPECT_GE(compare(SkipRule::culled_clusters, world, request).skipped, 20u);
}

// The ball is 8.4 m away and 1 m wide: 6.8 degrees, no more than five of 64 beams that are 1.875 degrees
// wide.
TEST(SliceRules, BeamsThatSeeNothingAreNotSummed) {
  const Comparison ball = compare(SkipRule::empty_beams, ball_alone(make_sphere(0.5F, 16)), small_request());
  EXPECT_GE(ball.skipped, 64u - 5u);
  EXPECT_LT(ball.skipped, 64u);
  EXPECT_EQ(compare(SkipRule::empty_beams, bed_and_ball(), small_request()).skipped, 0u);
}

TEST(SliceRules, BeamsThatSeeNothingAreNotSummedInThePaperEither) {
  PingRequest request = small_request();
  request.settings.model = Model::paper;
  EXPECT_GE(compare(SkipRule::empty_beams, ball_alone(make_sphere(0.5F, 16)), request).skipped, 64u - 5u);
}

TEST(SliceRules, FacetsThatAreHeardFlatAreNotInterpolated) {
  for (const Model model : {Model::physical, Model::paper}) {
    PingRequest request = small_request();
    request.settings.model = model;
    EXPECT_EQ(compare(SkipRule::geometric_normals, ball_alone(faceted_ball(false)), request).skipped, 1u);
    EXPECT_EQ(compare(SkipRule::geometric_normals, ball_alone(faceted_ball(true)), request).skipped, 1u);
    const Comparison smooth =
        compare(SkipRule::geometric_normals, ball_alone(make_sphere(0.5F, 16)), request);
    EXPECT_EQ(smooth.skipped, 0u);
    EXPECT_EQ(smooth.worst_of_maximum, 0.0);
  }
}

// Facets that are shaded flat though their normals are not would be another image: the criterion is needed.
TEST(SliceRules, SmoothNormalsAreHeard) {
  SonarRenderer smooth(ball_alone(make_sphere(0.5F, 16)), on_cpu());
  SonarRenderer flat(ball_alone(faceted_ball(true)), on_cpu());
  const std::vector<float> a = smooth.render_echo(small_request()).intensity;
  const std::vector<float> b = flat.render_echo(small_request()).intensity;
  const float largest = *std::max_element(a.begin(), a.end());
  float worst = 0.0F;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(a[i] - b[i]));
  }
  EXPECT_GT(worst, 10 * static_cast<float>(entry_of(SkipRule::geometric_normals).bound) * largest);
}

// A bed that is mapped is not merged either.
TEST(SliceRules, PartsWithoutANormalMapAreNotMapped) {
  const auto compare_map = [](bool mapped) {
    return compare(SkipRule::absent_normal_map, mappable_bed(mapped), small_request(),
                   {SkipRule::coplanar_facets});
  };
  EXPECT_EQ(compare_map(false).skipped, 1u);
  const Comparison mapped = compare_map(true);
  EXPECT_EQ(mapped.skipped, 0u);
  EXPECT_EQ(mapped.worst_of_maximum, 0.0);
}

// A bed of 40 x 40 cells and the six faces of a box of 16 x 16: each keeps two facets. Coarser presets follow
// the corners of the facets, so merged facets change single bins by more than the rule changes the surface.
// In the paper a bin is a mean, even over very little echo at the box's edges.
TEST(SliceRules, FacetsInOnePlaneAreMerged) {
  PingRequest request = small_request();
  request.settings.sampling.preset = Sampling::Preset::reference;
  EXPECT_EQ(compare(SkipRule::coplanar_facets, divided_bed_and_box(), request).skipped,
            2u * (40 * 40 + 6 * 16 * 16 - 7));
  for (const Model model : {Model::physical, Model::paper}) {
    request.settings.model = model;
    EXPECT_EQ(compare(SkipRule::coplanar_facets, mappable_bed(false), request).skipped, 2u * (40 * 40 - 1));
  }
}

TEST(SliceRules, TheGpuSeesMergedFacetsToo) {
  require_gl();
  const auto skipped = [](const World& world) {
    return compare(SkipRule::coplanar_facets, world, small_request(), {}, EngineKind::gpu).skipped;
  };
  EXPECT_EQ(skipped(divided_bed_and_box()), 2u * (40 * 40 + 6 * 16 * 16 - 7));
  EXPECT_EQ(skipped(ball_alone(faceted_ball(false))), 0u);
  EXPECT_EQ(skipped(mappable_bed(false)), 2u * (40 * 40 - 1));
}

TEST(SliceRules, FacetsInDifferentPlanesAreNotMerged) {
  for (const bool with_normals : {false, true}) {
    const Comparison ball =
        compare(SkipRule::coplanar_facets, ball_alone(faceted_ball(with_normals)), small_request());
    EXPECT_EQ(ball.skipped, 0u);
    EXPECT_EQ(ball.worst_of_maximum, 0.0);
  }
}

// Facets with vertex normals or with a normal map are not merged.
TEST(SliceRules, FacetsThatAreNotHeardFlatAreNotMerged) {
  for (const World& world : {ball_alone(make_sphere(0.5F, 16)), mappable_bed(true)}) {
    const Comparison comparison = compare(SkipRule::coplanar_facets, world, small_request());
    EXPECT_EQ(comparison.skipped, 0u);
    EXPECT_EQ(comparison.worst_of_maximum, 0.0);
  }
}

TEST(SliceRules, ElevationPatternThatIsFlatIsNotTabled) {
  PingRequest request = small_request();
  EXPECT_EQ(compare(SkipRule::flat_elevation, bed_and_ball(), request).skipped, 1u);
  request.settings.aperture.elevation = Aperture::Elevation::sinc;
  EXPECT_EQ(compare(SkipRule::flat_elevation, bed_and_ball(), request).skipped, 0u);
}

TEST(SliceRules, NothingSkippedAtAllTheImageIsTheSame) {
  PingRequest request = small_request();
  request.settings.sampling.preset = Sampling::Preset::reference;
  RendererOptions none = on_cpu();
  none.skip = SkipSwitches::none();
  SonarRenderer renderer(bed_and_ball(), on_cpu());
  SonarRenderer full(bed_and_ball(), none);
  const std::vector<float> a = renderer.render_echo(request).intensity;
  for (int ping = 0; ping < 2; ++ping) {
    const std::vector<float>& b = full.render_echo(request).intensity;
    EXPECT_EQ(full.last_statistics().skipped, SkipCounts{});
    const float largest = *std::max_element(b.begin(), b.end());
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_NEAR(a[i], b[i], 1e-3F * largest) << i;
    }
  }
}

}  // namespace
}  // namespace sonard::render
