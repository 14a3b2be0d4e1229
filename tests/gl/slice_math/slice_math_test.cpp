// SPDX-License-Identifier: Apache-2.0
// The arithmetic of slices is one text in two languages: compiled as GLSL 4.30 and as C++, it must give the
// same numbers.
#include "renderer/engines/slices/slice_math.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <osg/GLExtensions>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gpu_buffer.hpp"
#include "tests/support/gl_context_test.hpp"

namespace sonard::render {
namespace {

using Numbers = std::vector<float>;

constexpr int rounds = 8192;

/// A function of some numbers, in both languages.
struct Case {
  std::string glsl;  ///< reads get(k) and calls put(value), in the order of the outputs
  int outputs;
  bool to_the_bit;  ///< on software OpenGL; compilers may reassociate what is not `precise`
  std::function<Numbers(std::mt19937&)> make_inputs;
  std::function<Numbers(const Numbers&)> cpp;
};

float uniform(std::mt19937& random, double low, double high) {
  return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random));
}

std::string text_of(const std::string& name) {
  std::ifstream file(std::filesystem::path(SONARD_SOURCE_DIR) / "renderer/engines/slices" / name);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_FALSE(text.str().empty()) << name;
  return text.str();
}

/// The shader that computes a case for each round. It needs no extension and no version above 4.30.
std::string shader_of(const Case& tested, std::size_t inputs) {
  std::string text =
      "#version 430\n"
      "layout(local_size_x = 64) in;\n"
      "layout(std430, binding = 0) readonly buffer Inputs { float inputs[]; };\n"
      "layout(std430, binding = 1) writeonly buffer Outputs { float outputs[]; };\n";
  for (const char* name : {"language.glsl", "cut.glsl", "place.glsl", "sweep.glsl", "sides.glsl",
                           "refine.glsl", "patches.glsl", "facets.glsl"}) {
    text += text_of(name);
  }
  const std::string place = "int(gl_GlobalInvocationID.x) * ";
  return text + "int written = 0;\nfloat get(int k) { return inputs[" + place + std::to_string(inputs) +
         " + k]; }\nvoid put(float value) { outputs[" + place + std::to_string(tested.outputs) +
         " + written++] = value; }\nvoid main() {\n" + tested.glsl + "}\n";
}

class SliceMathTest : public test::GlContextTest {
 protected:
  Numbers on_gpu(const std::string& shader, const Numbers& inputs, std::size_t outputs) {
    osg::State& state = *context_->getState();
    osg::GLExtensions& gl = *state.get<osg::GLExtensions>();
    const auto program =
        context_->build_program({new osg::Shader(osg::Shader::COMPUTE, shader)}, "the case's shader");
    gl.glUseProgram(program->getPCP(state)->getHandle());
    GpuBuffer in(gl), out(gl);
    in.fill(inputs);
    out.hold(outputs * sizeof(float));
    gl.glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in.name());
    gl.glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out.name());
    gl.glDispatchCompute(rounds / 64, 1, 1);
    return test::read_back<float>(gl, out, outputs);
  }

  /// A card may divide and take roots with an error of a few units in the last place, and then decide a few
  /// borderline cases otherwise.
  void expect_equal(const Case& tested) {
    std::mt19937 random(7);
    Numbers inputs, expected;
    for (int i = 0; i < rounds; ++i) {
      const Numbers of_round = tested.make_inputs(random);
      inputs.insert(inputs.end(), of_round.begin(), of_round.end());
      const Numbers result = tested.cpp(of_round);
      ASSERT_EQ(result.size(), static_cast<std::size_t>(tested.outputs));
      expected.insert(expected.end(), result.begin(), result.end());
    }
    const Numbers found = on_gpu(shader_of(tested, inputs.size() / rounds), inputs, expected.size());
    const bool exactly = tested.to_the_bit && context_->software();
    const auto outputs = static_cast<std::size_t>(tested.outputs);
    std::size_t different = 0, finite = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const float a = expected[i], b = found[i];
      float largest = 0.0F;  // of the round: sums may cancel
      for (std::size_t k = i - i % outputs; k < i - i % outputs + outputs; ++k) {
        largest = std::max(largest, std::abs(expected[k]));
      }
      const bool near = std::abs(a - b) <= 1e-4F * std::abs(a) + 1e-6F * largest;
      const bool same = a == b || (std::isnan(a) && std::isnan(b)) || (!exactly && near);
      finite += std::isfinite(a) ? 1 : 0;
      if (!same && ++different < 5) {
        std::cerr << "round " << i / outputs << ", output " << i % outputs << ": " << a << " in C++, " << b
                  << " in GLSL\n";
      }
    }
    EXPECT_LE(different, context_->software() ? 0 : expected.size() / 500);
    EXPECT_GT(finite, expected.size() / 2) << "the case tests something";
  }
};

/// Corners of triangles of 1 cm to 3 m, 0.1 to 30 m away. A third are crossed by the slice at azimuth 0.
Numbers corners(std::mt19937& random) {
  const float size = std::exp(uniform(random, -4.6, 1.1));
  const float range = std::exp(uniform(random, -2.3, 3.4));
  Numbers numbers;
  const float azimuth = uniform(random, -1, 1) * 3 * size / (range + size);
  const float t = uniform(random, -0.4, 0.4);
  for (int k = 0; k < 3; ++k) {
    numbers.push_back(range * std::cos(azimuth) + uniform(random, -1, 1) * size);
    numbers.push_back(range * std::sin(azimuth) + uniform(random, -1, 1) * size);
    numbers.push_back(range * t + uniform(random, -1, 1) * size);
  }
  return numbers;
}

TEST_F(SliceMathTest, Cut) {
  expect_equal({R"(
    CutTriangle cut = cut_triangle(Corner(get(0), get(1), get(2)), Corner(get(3), get(4), get(5)),
                                   Corner(get(6), get(7), get(8)), get(9), get(10), get(11));
    put(float(cut.fate));
    bool kept = cut.fate == cut_keeps;
    put(kept ? cut.low : 0.0); put(kept ? cut.high : 0.0); put(kept ? cut.w_at_0 : 0.0); put(kept ? cut.w_slope : 0.0);
    put(kept ? cut.low_slope : 0.0); put(kept ? cut.high_slope : 0.0);
    put(kept ? cut.low_reach : 0.0); put(kept ? cut.high_reach : 0.0);
)",
                9, true,
                [](std::mt19937& random) {
                  Numbers numbers = corners(random);
                  const float azimuth = uniform(random, -0.02, 0.02);
                  numbers.insert(numbers.end(), {std::cos(azimuth), std::sin(azimuth), 0.3F});
                  return numbers;
                },
                [](const Numbers& x) {
                  const slices::CutTriangle cut = slices::cut_triangle(
                      {x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {x[6], x[7], x[8]}, x[9], x[10], x[11]);
                  if (cut.fate != slices::cut_keeps) {
                    return Numbers{static_cast<float>(cut.fate), 0, 0, 0, 0, 0, 0, 0, 0};
                  }
                  return Numbers{static_cast<float>(cut.fate),
                                 cut.low,
                                 cut.high,
                                 cut.w_at_0,
                                 cut.w_slope,
                                 cut.low_slope,
                                 cut.high_slope,
                                 cut.low_reach,
                                 cut.high_reach};
                }});
}

TEST_F(SliceMathTest, PlacedTriangles) {
  expect_equal(
      {R"(
    Corner a = Corner(get(0), get(1), get(2)), b = Corner(get(3), get(4), get(5)), c = Corner(get(6), get(7), get(8));
    Sight at_a = sight_of(a), at_b = sight_of(b), at_c = sight_of(c);
    put(at_a.azimuth); put(at_a.horizontal_squared); put(at_a.tangent);
    TriangleBounds bounds = bounds_of_triangle(at_a, at_b, at_c, a.z, b.z, c.z, FanLimits(0.3, 5e-3));
    put(float(bounds.in_elevation)); put(float(bounds.thin)); put(float(bounds.upright));
    put(bounds.low_azimuth); put(bounds.high_azimuth);
    put(is_turned_away(a, b, c, get(9)) ? 1.0 : 0.0);
    Corner moved = place(Placement(get(0), get(1), get(2), get(3), get(4), get(5), get(6), get(7), get(8), get(0), get(1),
                                   get(2)), a.x, a.y, a.z);
    put(moved.x); put(moved.y); put(moved.z);
    put(misses_fan(FanSpace(5.0, 0.2, 0.98, get(9) < 0.0 ? 0 : 1, -0.5, 0.87, -0.5, -0.87), a, 0.1) ? 1.0 : 0.0);
)",
       13, false,
       [](std::mt19937& random) {
         Numbers numbers = corners(random);
         if (uniform(random, 0, 1) < 0.3F) {  // an upright edge
           numbers[3] = numbers[0] * (1 + uniform(random, -1e-3, 1e-3));
           numbers[4] = numbers[1] * (1 + uniform(random, -1e-3, 1e-3));
         }
         numbers.push_back(std::floor(uniform(random, -1, 2)));
         return numbers;
       },
       [](const Numbers& x) {
         const slices::Corner a{x[0], x[1], x[2]}, b{x[3], x[4], x[5]}, c{x[6], x[7], x[8]};
         const slices::Sight at_a = slices::sight_of(a);
         const auto bounds = slices::bounds_of_triangle(at_a, slices::sight_of(b), slices::sight_of(c), a.z,
                                                        b.z, c.z, {0.3F, 5e-3F});
         const slices::Corner moved = slices::place(
             {x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8], x[0], x[1], x[2]}, a.x, a.y, a.z);
         return Numbers{
             at_a.azimuth,
             at_a.horizontal_squared,
             at_a.tangent,
             static_cast<float>(bounds.in_elevation),
             static_cast<float>(bounds.thin),
             static_cast<float>(bounds.upright),
             bounds.low_azimuth,
             bounds.high_azimuth,
             slices::is_turned_away(a, b, c, x[9]) ? 1.0F : 0.0F,
             moved.x,
             moved.y,
             moved.z,
             slices::misses_fan({5.0F, 0.2F, 0.98F, x[9] < 0 ? 0 : 1, -0.5F, 0.87F, -0.5F, -0.87F}, a, 0.1F)
                 ? 1.0F
                 : 0.0F};
       }});
}

/// Two segments that both reach over `from`; a third of them cross, a third touch.
Numbers two_lines(std::mt19937& random) {
  const float from = uniform(random, -0.3, 0.2), until = from + uniform(random, 1e-4, 0.2);
  const float w = std::exp(uniform(random, -3, 1)), slope = uniform(random, -1, 1) * w;
  const int kind = std::uniform_int_distribution<int>(0, 2)(random);
  const float other_slope = slope + uniform(random, -1, 1) * w;
  const float meeting = kind == 1 ? until : uniform(random, from, until);
  const float apart = kind == 0 ? w * uniform(random, -0.1, 0.1) : 0.0F;
  return {until,
          w - slope * meeting,
          slope,
          until + uniform(random, 0, 0.1),
          w + apart - other_slope * meeting,
          other_slope,
          from};
}

TEST_F(SliceMathTest, Crossing) {
  expect_equal({R"(
    Line a = Line(3, get(0), get(1), get(2)), b = Line(5, get(3), get(4), get(5));
    float at = crossing_of(a, b, get(6));
    put(at);
    put(is_seen_first(a, b, get(6), at) ? 1.0 : 0.0);
)",
                2, true, two_lines, [](const Numbers& x) {
                  const slices::Line a{3, x[0], x[1], x[2]}, b{5, x[3], x[4], x[5]};
                  const float at = slices::crossing_of(a, b, x[6]);
                  return Numbers{at, slices::is_seen_first(a, b, x[6], at) ? 1.0F : 0.0F};
                }});
}

TEST_F(SliceMathTest, Sides) {
  expect_equal(
      {R"(
    put(float(probe_above(get(0), get(1))));
    put(probe_at(get(1), int(get(2))));
    put(slope_within(get(3), get(4), get(0), get(5), get(1)));
    put(w_per_azimuth(get(6), get(7), get(8), get(9), get(10), get(0)));
)",
       4, true,
       [](std::mt19937& random) {
         return Numbers{
             uniform(random, -0.3, 0.3), uniform(random, 0.1, 0.3), std::floor(uniform(random, 0, 256)),
             uniform(random, -5, 5),     uniform(random, 0, 0.1),   uniform(random, 1e-3, 1e-2),
             uniform(random, 0.02, 2),   uniform(random, -1, 1),    uniform(random, -1, 1),
             uniform(random, -1, 1),     uniform(random, -1, 1)};
       },
       [](const Numbers& x) {
         return Numbers{static_cast<float>(slices::probe_above(x[0], x[1])),
                        slices::probe_at(x[1], static_cast<int>(x[2])),
                        slices::slope_within(x[3], x[4], x[0], x[5], x[1]),
                        slices::w_per_azimuth(x[6], x[7], x[8], x[9], x[10], x[0])};
       }});
}

TEST_F(SliceMathTest, BordersOfSlices) {
  expect_equal(
      {R"(
    ProbePair w = ProbePair(get(0), get(1), get(2), get(3), get(4), 7);
    ProbeDisagreement found = compare_probe(w, BorderLimits(get(5), get(6), get(7), get(8), get(9)));
    put(float(found.mismatched));
    put(float(found.curved));
    put(moment_of(get(1), get(2), get(4), get(10), get(6), get(11), get(12)));
)",
       3, false,
       [](std::mt19937& random) {
         const float w = std::exp(uniform(random, -3.5, 0));
         const auto near = [&] {
           return uniform(random, 0, 1) < 0.1F ? 0.0F : w * (1 + uniform(random, -3e-3, 3e-3));
         };
         const Numbers profiles{near(), near(), near(), near()};
         Numbers numbers = profiles;
         const float secant = uniform(random, 1, 1.05);
         numbers.insert(numbers.end(),
                        {secant, 0.02F, 20, uniform(random, 1e-5, 1e-2), 0.125F, uniform(random, 0.05, 0.3),
                         secant + uniform(random, -1e-3, 1e-3), 700, uniform(random, 0, 1)});
         return numbers;
       },
       [](const Numbers& x) {
         const auto found =
             slices::compare_probe({x[0], x[1], x[2], x[3], x[4], 7}, {x[5], x[6], x[7], x[8], x[9]});
         return Numbers{static_cast<float>(found.mismatched), static_cast<float>(found.curved),
                        slices::moment_of(x[1], x[2], x[4], x[10], x[6], x[11], x[12])};
       }});
}

TEST_F(SliceMathTest, PartsOfASlice) {
  expect_equal({R"(
    SliceErrors slice = SliceErrors(get(0), get(1), get(2), get(3), get(4), get(5), get(6), get(7), get(8));
    put(float(parts_of_slice(slice, DivisionLimits(75, 125, 2e-3, 0.2))));
)",
                1, true,
                [](std::mt19937& random) {
                  const auto small = [&] { return std::exp(uniform(random, -9, 0)); };
                  return Numbers{small(), small(), uniform(random, 1, 20),
                                 small(), small(), small(),
                                 small(), small(), std::max(0.0F, uniform(random, -0.1, 0.1))};
                },
                [](const Numbers& x) {
                  return Numbers{static_cast<float>(slices::parts_of_slice(
                      {x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8]}, {75, 125, 2e-3F, 0.2F}))};
                }});
}

TEST_F(SliceMathTest, PointsOfAPlane) {
  expect_equal({R"(
    PlanePoint p = point_of_plane(PlaneLine(get(0), get(1), get(2), get(3), get(4)), get(5), get(6));
    put(p.secant); put(p.range_m); put(p.by_azimuth); put(p.by_t); put(p.cosine);
    CosineRun run = cosine_run(get(7), get(8), get(9));
    put(run.mean); put(run.gradient);
    put(cosine_of_normal(get(2), get(3), get(4), get(5)));
    put(mean_weight(get(5), get(10), get(7), get(8), get(9), get(11)));
)",
                9, true,
                [](std::mt19937& random) {
                  const float t = uniform(random, -0.3, 0.3);
                  return Numbers{
                      uniform(random, 0.05, 2),    uniform(random, -1, 1),         uniform(random, -1, 1),
                      uniform(random, -1, 1),      uniform(random, -1, 1),         t,
                      uniform(random, 1e-3, 1e-2), uniform(random, 0, 1),          uniform(random, 0, 1),
                      uniform(random, 0, 1),       t + uniform(random, 1e-4, 0.1), uniform(random, -1, 1)};
                },
                [](const Numbers& x) {
                  const auto p = slices::point_of_plane({x[0], x[1], x[2], x[3], x[4]}, x[5], x[6]);
                  const auto run = slices::cosine_run(x[7], x[8], x[9]);
                  return Numbers{p.secant,
                                 p.range_m,
                                 p.by_azimuth,
                                 p.by_t,
                                 p.cosine,
                                 run.mean,
                                 run.gradient,
                                 slices::cosine_of_normal(x[2], x[3], x[4], x[5]),
                                 slices::mean_weight(x[5], x[10], x[7], x[8], x[9], x[11])};
                }});
}

TEST_F(SliceMathTest, SegmentsOfAPlane) {
  expect_equal({R"(
    PlaneLine plane = PlaneLine(get(0), get(1), get(2), get(3), get(4));
    PlaneSegment s = segment_of_plane(plane, get(5), get(6), get(7), get(8), get(9));
    put(s.range_low); put(s.range_mid); put(s.range_high); put(s.by_azimuth_low); put(s.by_azimuth_high);
    put(s.cosine_low); put(s.cosine_mid); put(s.cosine_high); put(s.solid_angle);
    put(crossing_excess(get(7), get(8), get(6) - get(5), get(9)));
    put(is_one_surface(get(0), get(0) * (1.0 + 1e-4 * get(7))) ? 1.0 : 0.0);
)",
                11, true,
                [](std::mt19937& random) {
                  const float t = uniform(random, -0.3, 0.3);
                  return Numbers{uniform(random, 0.05, 2),
                                 uniform(random, -1, 1),
                                 uniform(random, -1, 1),
                                 uniform(random, -1, 1),
                                 uniform(random, -1, 1),
                                 t,
                                 t + std::exp(uniform(random, -9, -2)),
                                 uniform(random, -2, 2),
                                 uniform(random, -2, 2),
                                 uniform(random, 1e-3, 1e-2)};
                },
                [](const Numbers& x) {
                  const auto s =
                      slices::segment_of_plane({x[0], x[1], x[2], x[3], x[4]}, x[5], x[6], x[7], x[8], x[9]);
                  return Numbers{s.range_low,
                                 s.range_mid,
                                 s.range_high,
                                 s.by_azimuth_low,
                                 s.by_azimuth_high,
                                 s.cosine_low,
                                 s.cosine_mid,
                                 s.cosine_high,
                                 s.solid_angle,
                                 slices::crossing_excess(x[7], x[8], x[6] - x[5], x[9]),
                                 slices::is_one_surface(x[0], x[0] * (1.0F + 1e-4F * x[7])) ? 1.0F : 0.0F};
                }});
}

TEST_F(SliceMathTest, PartsOfASegment) {
  expect_equal(
      {R"(
    UnevenSegment s = UnevenSegment(get(0), get(1), get(2), get(3), get(4), get(5), get(6) > 0.5, get(7) > 0.5, get(8));
    PatchLimits limits = PatchLimits(3e-4, 20.0, 5e-3, 0.025, 0.17, 0.01, 0.04);
    int parts = parts_of_segment(s, limits);
    put(float(parts)); put(end_of_part(get(9), get(9) + get(0), turn_of_range(2.0, get(10)), 1, parts));
    put(within_one(get(10)));
)",
       3, false,
       [](std::mt19937& random) {
         const float range = uniform(random, 1, 22);
         const auto beside = [&] { return range + std::exp(uniform(random, -9, -3)); };
         return Numbers{std::exp(uniform(random, -9, -2)),
                        beside(),
                        beside(),
                        beside(),
                        uniform(random, 0, 0.01),
                        std::exp(uniform(random, -12, -1)),
                        uniform(random, 0, 1),
                        uniform(random, 0, 1),
                        uniform(random, 0, 1),
                        uniform(random, -0.3, 0.3),
                        uniform(random, -2, 2)};
       },
       [](const Numbers& x) {
         const int parts =
             slices::parts_of_segment({x[0], x[1], x[2], x[3], x[4], x[5], x[6] > 0.5F, x[7] > 0.5F, x[8]},
                                      {3e-4F, 20.0F, 5e-3F, 0.025F, 0.17F, 0.01F, 0.04F});
         return Numbers{static_cast<float>(parts),
                        slices::end_of_part(x[9], x[9] + x[0], slices::turn_of_range(2.0F, x[10]), 1, parts),
                        slices::within_one(x[10])};
       }});
}

TEST_F(SliceMathTest, Gradients) {
  expect_equal({R"(
    RangeGradient found = gradient_of(RangeSpan(get(0), get(1), get(2), get(3), get(4), get(5), get(6), get(7), get(8),
                                                get(9) > 0.5), 1e-4, 20.0);
    put(found.smear_low); put(found.smear_high); put(found.gradient); put(found.displaced_m);
)",
                4, true,
                [](std::mt19937& random) {
                  const float t = uniform(random, -0.3, 0.3), length = std::exp(uniform(random, -9, -1));
                  const float range = std::exp(uniform(random, -1, 3.2));
                  const auto beside = [&] { return range * (1 + length * uniform(random, -5, 5)); };
                  return Numbers{t,
                                 t + length,
                                 beside(),
                                 beside(),
                                 beside(),
                                 range * uniform(random, 0, 0.01),
                                 range * uniform(random, 0, 0.01),
                                 length * uniform(random, 0, 2),
                                 uniform(random, -1, 1),
                                 uniform(random, 0, 1)};
                },
                [](const Numbers& x) {
                  const auto found = slices::gradient_of(
                      {x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8], x[9] > 0.5F}, 1e-4F, 20.0F);
                  return Numbers{found.smear_low, found.smear_high, found.gradient, found.displaced_m};
                }});
}

TEST_F(SliceMathTest, Facets) {
  expect_equal({R"(
    NormalField n = NormalField(get(0), get(1), get(2), get(3), get(4), get(5), get(6), get(7), get(8));
    FacetResponse found = facets_of_segment(n, FacetMaterial(get(9), get(10)), get(11), get(12), get(13));
    put(found.mean); put(found.moment); put(found.gradient);
    FacetTurn turn = turn_of_facets(n, get(11), get(13));
    put(turn.along_per_t); put(turn.across_rad); put(turn.cosine); put(range_slope(n, get(13), get(11)));
    put(facets_may_respond(turn, get(12) - get(11), 0.9) ? 1.0 : 0.0);
    put(float(patches_side_by_side(get(9), get(10), 0.01)));
)",
                9, false,
                [](std::mt19937& random) {
                  const float t = uniform(random, -0.3, 0.3);
                  Numbers numbers{-1, uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5)};
                  for (int k = 0; k < 6; ++k) {
                    numbers.push_back(uniform(random, -2, 2));
                  }
                  numbers.insert(numbers.end(),
                                 {uniform(random, 0.01, 1), std::exp(uniform(random, -8, -2)), t,
                                  t + uniform(random, 1e-4, 0.1), uniform(random, 1e-3, 1e-2)});
                  return numbers;
                },
                [](const Numbers& x) {
                  const slices::NormalField n{x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8]};
                  const auto found = slices::facets_of_segment(n, {x[9], x[10]}, x[11], x[12], x[13]);
                  const auto turn = slices::turn_of_facets(n, x[11], x[13]);
                  return Numbers{found.mean,
                                 found.moment,
                                 found.gradient,
                                 turn.along_per_t,
                                 turn.across_rad,
                                 turn.cosine,
                                 slices::range_slope(n, x[13], x[11]),
                                 slices::facets_may_respond(turn, x[12] - x[11], 0.9F) ? 1.0F : 0.0F,
                                 static_cast<float>(slices::patches_side_by_side(x[9], x[10], 0.01F))};
                }});
}

}  // namespace
}  // namespace sonard::render
