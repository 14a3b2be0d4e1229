// SPDX-License-Identifier: Apache-2.0
// Error estimates of images whose error is known: the test writes the samples into textures.
#include "renderer/engines/gpu/beam_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <GL/gl.h>
#include <gtest/gtest.h>
#include <osg/GLExtensions>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gpu_binner.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

constexpr double step_m = 0.02;

/// Three beams of half a degree, sampled evenly in one view; estimates are for the middle one.
class BeamEstimateTest : public ::testing::Test {
 protected:
  static constexpr int columns_per_beam = 8;

  void SetUp() override { test::require_gl(); }

  BeamEstimateTest() {
    for (int i = 0; i < 4; ++i) {
      aperture_.beam_edges_rad.push_back(0.0135 - 0.009 * i);
    }
    make_grid(columns_per_beam, 64);
  }

  void make_grid(int columns, int rows) {
    const auto of = [&](int c, int r) {
      return make_sample_grid(aperture_, std::vector<BeamRun>{{0, 3, {{0.0135, -0.0135, c}}, r}});
    };
    grid_ = of(3 * columns, rows);
    thinned_ = of(3 * columns / 2, rows / 2);
  }

  /// A texture of the view's size, transposed.
  GLuint make_texture(RasterSampler& sampler, const std::vector<SurfaceSample>& samples) const {
    GLuint texture = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D_ARRAY, texture);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    sampler.current_context().getState()->get<osg::GLExtensions>()->glTexImage3D(
        GL_TEXTURE_2D_ARRAY, 0, GL_RGBA32F, grid_.views[0].rows, grid_.views[0].columns, 1, 0, GL_RGBA,
        GL_FLOAT, samples.data());
    return texture;
  }

  /// @param what the sample at an azimuth, rad, and the tangent of an elevation
  BeamEstimate estimate_of(const std::function<SurfaceSample(double psi, double y)>& what,
                           const RangeLines& range = {1000, step_m, 0, false},
                           const BeamError& most_error = {1, 1}) {
    const SubView& view = grid_.views[0];
    std::vector<SurfaceSample> samples;
    for (int i = 0; i < view.columns; ++i) {
      const double x = -view.tan_half_width + (i + 0.5) * view.pixel_width();
      for (int j = 0; j < view.rows; ++j) {
        samples.push_back(what(-std::atan(x), -view.tan_half_height + (j + 0.5) * view.pixel_height()));
      }
    }
    RasterSampler sampler(World{});
    GpuBinner binner(sampler);
    sampler.current_context();
    const GLuint texture = make_texture(sampler, samples);
    const std::vector<float> no_weights;
    const BinningOptions options;
    const auto on_gpu = binner.load(grid_, {0, 1, 2}, &thinned_);
    binner.begin({3, range, options, no_weights, most_error});
    binner.add(*on_gpu, texture);
    binner.ask_estimates();
    const BeamEstimate found = binner.take_estimates().at(1);
    glDeleteTextures(1, &texture);
    return found;
  }

  /// Share of the middle beam to port of an upright edge if each column sees only its centre.
  double sampled_share(double edge_rad) const {
    double share = 0;
    const SubView& view = grid_.views[0];
    for (int p = grid_.beam_parts[1]; p < grid_.beam_parts[2]; ++p) {
      const ColumnPart& part = grid_.parts[static_cast<std::size_t>(p)];
      const double x = -view.tan_half_width + (part.column + 0.5) * view.pixel_width();
      share += -std::atan(x) > edge_rad ? static_cast<double>(part.width) : 0.0;
    }
    return share / (2 * std::tan(0.0045));
  }

  Aperture aperture_;
  SampleGrid grid_, thinned_;
};

TEST_F(BeamEstimateTest, AnUprightEdgeMayBeAnywhereBetweenTwoColumns) {
  // To port an echo of 1 at 5 m, to starboard one of 0.25 at 10 m.
  const double column_rad = 0.009 / columns_per_beam;
  double worst = 0;
  for (double edge = -0.0044; edge < 0.0044; edge += 0.0001) {
    const BeamEstimate estimate = estimate_of([&](double psi, double) {
      return psi > edge ? SurfaceSample{5, 1, 0, 0} : SurfaceSample{10, 0.25F, 0, 0};
    });
    const double share = (0.0045 - edge) / 0.009;
    const double total = share + 0.25 * (1 - share);
    const double found = sampled_share(edge) + 0.25 * (1 - sampled_share(edge));
    // The beam meets a jump to a column of the next beam only once.
    const double allowed = std::abs(edge) > 0.0045 - column_rad / 2 ? std::numbers::sqrt2 : 1.0;
    const double error = std::abs(found - total) / found;
    EXPECT_LE(error, 1.02 * allowed * static_cast<double>(estimate.columns_total)) << edge;
    worst = std::max(worst, error / static_cast<double>(estimate.columns_total));
    EXPECT_LE(static_cast<double>(estimate.columns_total) * found, 0.75 * column_rad / 0.009)
        << "as if it were nowhere";
    const auto lines = [](double part, double all) { return (250 * part + 500 * 0.25 * (1 - part)) / all; };
    const double centroid_error = std::abs(lines(sampled_share(edge), found) - lines(share, total));
    EXPECT_LE(centroid_error, 1.1 * allowed * static_cast<double>(estimate.columns_centroid_lines)) << edge;
    EXPECT_LT(static_cast<double>(estimate.rows_total), 1e-5);
  }
  EXPECT_GT(worst, 0.8) << "no more than it may be";
}

TEST_F(BeamEstimateTest, TheEdgeIsInTheColumnsThatAreSaidToBeOff) {
  const double edge = 0.001;
  const BeamEstimate estimate = estimate_of(
      [&](double psi, double) {
        return psi > edge ? SurfaceSample{5, 1, 0, 0} : SurfaceSample{};
      },
      {1000, step_m, 0, false}, {1e-3, 0.05});
  // The columns on either side of it.
  const double column_rad = 0.009 / columns_per_beam;
  const int before = static_cast<int>((0.0045 - edge) / column_rad - 0.5);
  EXPECT_EQ(estimate.zone_begin, before);
  EXPECT_EQ(estimate.zone_end, before + 2);
}

TEST_F(BeamEstimateTest, ALevelEdgeMayBeAnywhereBetweenTwoRows) {
  const double half = std::tan(aperture_.elevation_limit_rad());
  const SubView& view = grid_.views[0];
  for (double edge = -0.9 * half; edge < 0.9 * half; edge += 0.013 * half) {
    const BeamEstimate estimate = estimate_of([&](double, double y) {
      return y < edge ? SurfaceSample{5, 1, 0, 0} : SurfaceSample{9, 0.5F, 0, 0};
    });
    // Approximate, since rows are equal in tangent.
    const double share = (edge + half) / (2 * half);
    const double rows = std::floor((edge + view.tan_half_height) / view.pixel_height() + 0.5);
    const double found = (rows * view.pixel_height() - view.tan_half_height + half) / (2 * half);
    const double error = 0.5 * std::abs(found - share) / (0.5 + 0.5 * found);
    EXPECT_LE(error, 1.1 * static_cast<double>(estimate.rows_total)) << edge;
    EXPECT_LE(static_cast<double>(estimate.rows_total), 0.6 / 64 / (0.5 + 0.5 * found)) << edge;
    EXPECT_LT(static_cast<double>(estimate.columns_total), 1e-6);
  }
}

TEST_F(BeamEstimateTest, WhatGoesOnIsNoEdge) {
  // A wall seen at a slant: echo and range change over the three beams.
  const BeamEstimate estimate = estimate_of([](double psi, double y) {
    return SurfaceSample{static_cast<float>(8 + 60 * psi + 2 * y), static_cast<float>(1 + 6 * psi + y), -60,
                         2};
  });
  EXPECT_LT(static_cast<double>(estimate.columns_total), 2e-4);
  EXPECT_LT(static_cast<double>(estimate.columns_centroid_lines), 0.01);
  EXPECT_LT(static_cast<double>(estimate.rows_total), 2e-4);
  EXPECT_LT(static_cast<double>(estimate.rows_centroid_lines), 0.02);
  EXPECT_EQ(estimate.thin, 0U);
}

TEST_F(BeamEstimateTest, TheLastLineIsNoEdge) {
  // A surface that leaves the range half way up the beam.
  const auto slope = [](double, double y) {
    return SurfaceSample{static_cast<float>(20 + 20 * y), 1, 0, 20};
  };
  const BeamEstimate within = estimate_of(slope, {2000, step_m, 0, false});
  const BeamEstimate cut = estimate_of(slope, {1000, step_m, 0, false});
  EXPECT_LT(within.rows_total, 1e-3F);
  EXPECT_LT(cut.rows_total, 1e-3F);
  // But a body in front of a surface out of range has one.
  const BeamEstimate body = estimate_of(
      [&](double psi, double) {
        return psi > 0.001 ? SurfaceSample{5, 1, 0, 0} : SurfaceSample{90, 1, 0, 0};
      },
      {1000, step_m, 0, false});
  EXPECT_GT(body.columns_total, 0.05F);
}

TEST_F(BeamEstimateTest, AnEdgeBetweenTwoBeamsIsNoticedByBoth) {
  // 0.0045 is the port edge of the middle beam. The last column of the beam to port sees the wall.
  make_grid(4, 64);
  const BeamEstimate estimate = estimate_of([&](double psi, double) {
    return psi > 0.0044 ? SurfaceSample{5, 1, 0, 0} : SurfaceSample{9, 0.5F, 0, 0};
  });
  EXPECT_GT(static_cast<double>(estimate.columns_total), 1e-4 / 0.009);
}

TEST_F(BeamEstimateTest, AnEchoInOneColumnAloneIsThin) {
  const auto thing = [&](double width_rad) {
    return estimate_of([=](double psi, double) {
      return std::abs(psi) < width_rad / 2 ? SurfaceSample{5, 1, 0, 0} : SurfaceSample{9, 0.2F, 0, 0};
    });
  };
  make_grid(9, 64);  // a column is 0.001 rad wide, and one is in the middle
  EXPECT_EQ(thing(0.0015).thin, 1U);
  EXPECT_EQ(thing(0.0035).thin, 0U);
}

TEST_F(BeamEstimateTest, SilenceHasNoEstimate) {
  const BeamEstimate estimate = estimate_of([](double, double) { return SurfaceSample{}; });
  EXPECT_EQ(estimate.bins, 0U);
  EXPECT_EQ(static_cast<double>(estimate.columns_total), 0);
  EXPECT_EQ(static_cast<double>(estimate.rows_centroid_lines), 0);
}

TEST_F(BeamEstimateTest, SamplesThatAreNoNumbersDoNotCount) {
  const BeamEstimate estimate = estimate_of([](double psi, double) {
    return SurfaceSample{5, std::abs(psi) < 0.0005 ? NAN : 1.0F, 0, 0};
  });
  EXPECT_TRUE(std::isfinite(static_cast<double>(estimate.columns_total)));
  EXPECT_TRUE(std::isfinite(static_cast<double>(estimate.columns_centroid_lines)));
}

}  // namespace
}  // namespace sonard::render
