// SPDX-License-Identifier: Apache-2.0
// Targets, structures and beds in images: worlds made here, and worlds of configs/.
#include <queue>
#include <set>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/scene/materials.hpp"
#include "tests/pictures/view.hpp"
#include "tests/realism/patches.hpp"
#include "tests/realism/rows.hpp"
#include "tests/realism/statistics.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"
#include "tests/support/gemini_client.hpp"

namespace sonard::realism {
namespace {

using test::GeminiImage;

constexpr int beams = gemini::beam_count;

struct Ask {
  double range_m = 20;
  double gain_percent = 50;
  int pings = 1;
  bool sixteen_bit = false;
  std::uint64_t seed = 7;
  bool no_bounces = false;
};

std::vector<GeminiImage> images_of(const render::World& world, const render::Pose& T_world_sonar,
                                   const Ask& ask) {
  server::HeadConfig head = server::gemini_type().make_default();
  if (ask.no_bounces) {
    head.acoustics.physical.multipath.most_bounces = 0;
  }
  gemini::PingSettings wanted;
  wanted.range_m = ask.range_m;
  wanted.gain_percent = ask.gain_percent;
  wanted.sixteen_bit = ask.sixteen_bit;
  render::SonarRenderer renderer(world, {render::EngineKind::cpu, 0});
  test::GeminiClient client(
      std::move(head), gemini::make_ping_config(wanted),
      [&](const render::PingRequest& request) { return renderer.render_ping(request); });
  client.T_world_sonar = T_world_sonar;
  client.seed = ask.seed;
  return client.images(ask.pings);
}

render::Body ball(const glm::dvec3& at_m, double radius_m) {
  render::Body body = test::make_body("ball", test::make_sphere(static_cast<float>(radius_m), 48));
  body.parts[0].material = *render::find_acoustic_material("steel_fouled");
  body.T_world_body.position_m = at_m;
  return body;
}

render::World balls(const std::vector<glm::dvec3>& at_m, double radius_m) {
  std::vector<render::Body> bodies;
  for (const glm::dvec3& at : at_m) {
    bodies.push_back(ball(at, radius_m));
  }
  return test::make_world(std::move(bodies));
}

double beam_sine(int beam) {
  return std::sin(60 * degree) * (1 - (2 * beam + 1.0) / beams);
}
int beam_at(double azimuth_rad) {
  return static_cast<int>((1 - std::sin(azimuth_rad) / std::sin(60 * degree)) * beams / 2);
}

/// Mean power over pings.
std::vector<double> mean_power(const std::vector<GeminiImage>& images) {
  std::vector<double> power(images.front().codes.size(), 0.0);
  for (const GeminiImage& image : images) {
    for (std::size_t i = 0; i < power.size(); ++i) {
      power[i] += image.codes[i] * image.codes[i] / static_cast<double>(images.size());
    }
  }
  return power;
}

struct Peak {
  int line = 0, beam = 0;
  double power = 0;
};
Peak peak_of(const std::vector<double>& power, int lines) {
  const auto at = std::max_element(power.begin(), power.begin() + lines * beams) - power.begin();
  return {static_cast<int>(at / beams), static_cast<int>(at % beams), power[static_cast<std::size_t>(at)]};
}

/// Number of cells beside the peak with at least half of its power, interpolated at both ends.
double width_of(const std::function<double(int)>& power) {
  double width = 0;
  for (const int direction : {-1, 1}) {
    int i = 0;
    while (power(i + direction) > power(0) / 2) {
      i += direction;
    }
    width += std::abs(i) + (power(i) - power(0) / 2) / (power(i) - power(i + direction));
  }
  return width;
}

/// A small ball at 10 m, a third of a degree wide, with a glint far above the noise.
const render::World& small_ball() {
  static const render::World world = balls({{10 * std::cos(0.2), 10 * std::sin(0.2), 0}}, 0.03);
  return world;
}

struct SmallBall {
  std::vector<double> power;
  Peak peak;
};
SmallBall see_small_ball(std::uint64_t seed, int pings) {
  const std::vector<GeminiImage> images =
      images_of(small_ball(), {},
                {.range_m = 50, .gain_percent = 50, .pings = pings, .sixteen_bit = true, .seed = seed});
  std::vector<double> power = mean_power(images);
  const Peak peak = peak_of(power, static_cast<int>(11 / images.front().line_m));
  return {std::move(power), peak};
}

double point_width(bool in_beams) {
  const SmallBall seen = see_small_ball(7, 20);
  return width_of([&](int i) {
    const int at = in_beams ? seen.peak.line * beams + seen.peak.beam + i
                            : (seen.peak.line + i) * beams + seen.peak.beam;
    return seen.power[static_cast<std::size_t>(at)];
  });
}

/// Spread of the brightest beam in single pings with other seeds: speckle, noise and elements differ.
double point_bearing_jitter() {
  std::vector<double> bearings_deg;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    bearings_deg.push_back(std::asin(beam_sine(see_small_ball(seed, 1).peak.beam)) / degree);
  }
  return sd_of(bearings_deg);
}

/// Power in the row of a ball in empty water, for beams more than 60 away from it, without the noise.
std::vector<double> leakage(std::uint64_t seed) {
  const render::World world = balls({{9 * std::cos(0.5), 9 * std::sin(0.5), 0}}, 0.2);
  const std::vector<double> power = mean_power(images_of(
      world, {}, {.range_m = 12, .gain_percent = 50, .pings = 30, .sixteen_bit = true, .seed = seed}));
  const Peak peak = peak_of(power, static_cast<int>(power.size()) / beams);
  std::vector<double> noise, far;
  for (int beam = 0; beam < beams; ++beam) {
    if (std::abs(beam - peak.beam) > 60 && std::abs(beam - beams / 2) > 6) {
      far.push_back(power[static_cast<std::size_t>(peak.line * beams + beam)] / peak.power);
      for (int line = peak.line - 60; line < peak.line - 40; ++line) {
        noise.push_back(power[static_cast<std::size_t>(line * beams + beam)] / peak.power);
      }
    }
  }
  const double floor = mean_of(noise);
  for (double& share : far) {
    share = std::max(share - floor, 0.0);
  }
  return far;
}

double leakage_db() {
  std::vector<double> medians_db;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    medians_db.push_back(decibels(quantile_of(leakage(seed), 0.5) + 1e-9));
  }
  return quantile_of(medians_db, 0.5);
}

double leakage_variation() {
  const std::vector<double> far = leakage(3);
  return sd_of(far) / mean_of(far);
}

struct Region {
  int cells = 0, first_beam = beams, last_beam = 0, line = 0;
};

/// Detects with two thresholds: cells of 60 or more, of which one has 120. Cells within a beamwidth (two
/// beams) and a pulse (four lines) of each other are one region, because the head cannot resolve them.
std::vector<Region> regions_of(const GeminiImage& image) {
  std::vector<Region> regions;
  std::set<int> left;
  for (int i = 0; i < image.lines * beams; ++i) {
    if (image.codes[static_cast<std::size_t>(i)] >= 60) {
      left.insert(i);
    }
  }
  while (!left.empty()) {
    Region region;
    double most = 0;
    std::queue<int> open;
    open.push(*left.begin());
    left.erase(left.begin());
    while (!open.empty()) {
      const int at = open.front();
      open.pop();
      const int line = at / beams, beam = at % beams;
      most = std::max(most, image.at(line, beam));
      region = {region.cells + 1, std::min(region.first_beam, beam), std::max(region.last_beam, beam), line};
      for (int dl = -4; dl <= 4; ++dl) {
        for (int db = -2; db <= 2; ++db) {
          const bool inside = beam + db >= 0 && beam + db < beams;
          if (const auto next = left.find(at + dl * beams + db); inside && next != left.end()) {
            open.push(*next);
            left.erase(next);
          }
        }
      }
    }
    if (most >= 120) {
      regions.push_back(region);
    }
  }
  return regions;
}

/// Two balls of 1 m, 6 m apart, at 10 m in empty water.
std::vector<Region> regions_of_two_balls(std::uint64_t seed) {
  const double aside = std::asin(0.3);
  const render::World world = balls({{10 * std::cos(aside), 3, 0}, {10 * std::cos(aside), -3, 0}}, 0.5);
  return regions_of(images_of(world, {}, {.range_m = 20, .seed = seed}).front());
}

/// Of several draws, the number of regions that is farthest from two.
double regions() {
  double farthest = 2;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto found = static_cast<double>(regions_of_two_balls(seed).size());
    farthest = std::abs(found - 2) > std::abs(farthest - 2) ? found : farthest;
  }
  return farthest;
}

/// Largest factor between a ball's width across the beams and its diameter of 1 m. The balls are at 17
/// degrees.
double size_of_a_ball() {
  double worst = 1;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    for (const Region& region : regions_of_two_balls(seed)) {
      const double size_m = 9.5 * (beam_sine(region.first_beam) - beam_sine(region.last_beam + 1)) / 0.95;
      worst = std::max({worst, size_m, 1 / size_m});
    }
  }
  return worst;
}

/// A world of configs/ seen by a head with default configuration, from the place of the gallery's picture.
GeminiImage world_of(const std::string& config, double range_m, std::uint64_t seed = 7) {
  const pictures::View view = pictures::configured_view(config, range_m);
  return images_of(view.world, view.T_world_sonar, {.range_m = range_m, .seed = seed}).front();
}

double most_saturated() {
  double most = 0;
  for (const auto& [config, range_m] :
       {std::pair{"demo.yaml", 20.0}, std::pair{"manifold.yaml", 25.0}, std::pair{"ssiv.yaml", 20.0}}) {
    const GeminiImage image = world_of(config, range_m);
    most = std::max(most, static_cast<double>(std::ranges::count(image.codes, 255.0)) /
                              static_cast<double>(image.codes.size()));
  }
  return most;
}

std::vector<double> codes_of(const GeminiImage& image, double from_m, double to_m, double from_deg,
                             double to_deg) {
  std::vector<double> codes;
  for (int line = static_cast<int>(from_m / image.line_m); line < static_cast<int>(to_m / image.line_m);
       ++line) {
    for (int beam = beam_at(-from_deg * degree); beam < beam_at(-to_deg * degree); ++beam) {
      codes.push_back(image.at(line, beam));
    }
  }
  return codes;
}
double mean_code(const GeminiImage& image, double from_m, double to_m, double from_deg, double to_deg) {
  return mean_of(codes_of(image, from_m, to_m, from_deg, to_deg));
}

/// The bed beside the docking station relative to its shadow, 20 to 22 m away. Medians, so that stones and
/// ghosts do not matter.
double shadow_db() {
  const GeminiImage image = world_of("demo.yaml", 25);
  const auto median = [&](double from_deg, double to_deg) {
    return quantile_of(codes_of(image, 20, 22, from_deg, to_deg), 0.5);
  };
  return 2 * decibels(std::min(median(-24, -14), median(12, 22)) / median(-12, 4));
}

/// Mean codes in mid-fan, each half metre from `from_m` on.
std::vector<double> mid_fan_codes(const GeminiImage& image, double from_m, double to_m, double half_deg) {
  std::vector<double> codes;
  for (double at_m = from_m; at_m < to_m; at_m += 0.5) {
    codes.push_back(mean_code(image, at_m, at_m + 0.5, -half_deg, half_deg));
  }
  return codes;
}

/// Increase of the level in mid-fan by bounces in each half metre, from the mean of all poses.
std::vector<double> bounces_db(const render::World& world, const std::vector<render::Pose>& T_world_sonar,
                               double range_m, double from_m, double to_m, double half_deg) {
  std::vector<double> with, without;
  for (const render::Pose& pose : T_world_sonar) {
    for (const bool no_bounces : {false, true}) {
      const GeminiImage image =
          images_of(world, pose, {.range_m = range_m, .sixteen_bit = true, .no_bounces = no_bounces}).front();
      const std::vector<double> codes = mid_fan_codes(image, from_m, to_m, half_deg);
      std::vector<double>& sums = no_bounces ? without : with;
      sums.resize(codes.size());
      std::ranges::transform(codes, sums, sums.begin(), std::plus());
    }
  }
  std::vector<double> brighter_db(with.size());
  std::ranges::transform(with, without, brighter_db.begin(),
                         [](double a, double b) { return 2 * decibels(a / b); });
  return brighter_db;
}

/// Depth behind the docking station's last wall, at 15.2 m, to which bounces add 1 dB or more. Paths are
/// random, so it takes the mean of nine places, each turned by another part of a cell.
double halo_m() {
  const pictures::View view = pictures::configured_view("demo.yaml", 30);
  std::vector<render::Pose> places;
  for (int k = 0; k < 9; ++k) {
    const glm::dquat turn = glm::angleAxis((k - 4) * 0.3 * degree, glm::dvec3(0, 0, 1));
    places.push_back({view.T_world_sonar.position_m + glm::dvec3(0.3 * (k % 3 - 1), 0.3 * (k / 3 - 1), 0),
                      turn * view.T_world_sonar.orientation});
  }
  const std::vector<double> brighter = bounces_db(view.world, places, 30, 15.5, 25, 5);
  const auto end = std::ranges::find_if(brighter, [](double level_db) { return level_db < 1; });
  return 0.3 + 0.5 * static_cast<double>(end - brighter.begin());
}

/// Increase of the level by bounces behind the tank's farthest corner, which is 12 m away, up to 24 m.
double tail_db() {
  const render::World tank = render::load_world(SONARD_SOURCE_DIR "/configs/worlds/tank.sdf");
  return quantile_of(bounces_db(tank, {{{-1, -0.5, -4}, {1, 0, 0, 0}}}, 25, 13, 24, 55), 0.5);
}

double highlights_db() {
  const GeminiImage image = world_of("demo.yaml", 40);
  gemini::PingSettings wanted;
  wanted.range_m = 40;
  test::GeminiClient silent(server::gemini_type().make_default(), gemini::make_ping_config(wanted),
                            test::EvenEcho(0));
  return 2 *
         decibels(quantile_of(image.codes, 0.999) / mean_code(silent.images(1).front(), 36, 39, -55, -10));
}

/// For an even bed of sand 5 m under the sonar.
double bed_index() {
  render::Body bed = test::make_body("bed", test::make_quad({-50, -50, -5}, {100, 0, 0}, {0, 100, 0}));
  bed.parts[0].material = *render::find_acoustic_material("sand");
  const GeminiImage image = images_of(test::make_world({bed}), test::looking({0, 0, 0}, 0, 20),
                                      {.range_m = 20, .sixteen_bit = true})
                                .front();
  return median_of(homogeneous_patches({image.lines, beams, 65535, image.codes}), Third::middle).index;
}

/// Share of bright cells in near water: at least ten times the median.
double clutter_share() {
  const render::World world = balls({{90, 0, 0}}, 0.1);
  int bright = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const GeminiImage image = images_of(world, {}, {.range_m = 20, .seed = seed}).front();
    for (int line = static_cast<int>(0.9 / image.line_m); line < static_cast<int>(10 / image.line_m);
         ++line) {
      for (int beam = 0; beam < beams; ++beam, ++all) {
        bright += image.at(line, beam) >= 12 ? 1 : 0;
      }
    }
  }
  return static_cast<double>(bright) / all;
}

}  // namespace

std::vector<Row> gemini_scene_rows() {
  return {
      {"Gemini", "leakage of a ball: median of its row beyond 60 beams", "-30 or less, about -35", -40, -30,
       "dB", leakage_db},
      {"Gemini", "the same: variation along the row", "patchy", 0.3, 1.5, "", leakage_variation},
      {"Gemini", "a point: width at -3 dB", "3.5", 2.4, 3.6, "beams", [] { return point_width(true); }},
      {"Gemini", "a point: length at -3 dB", "4.2 (2.1 averages of two)", 3, 5, "bins",
       [] { return point_width(false); }},
      {"Gemini", "a point: its bearing from draw to draw", "0", 0, 0.1, "degrees", point_bearing_jitter},
      {"Gemini", "two balls of 1 m and a detector with thresholds 120 and 60: regions", "2", 2, 2, "",
       regions},
      {"Gemini", "the same: width of a region over the diameter of its ball", "1", 1, 1.5, "",
       size_of_a_ball},
      {"Gemini", "bed beside the docking station over its shadow, behind the halo", "10 or more", 10, 40,
       "dB", shadow_db},
      {"Gemini", "halo behind the docking station: depth", "3 to 6", 2.5, 6, "m", halo_m},
      {"Gemini", "behind the walls of a tank: tail over the same without bounces", "more than 0", 3, 30, "dB",
       tail_db},
      {"Gemini", "most saturated of the docking station, the manifold and the valves",
       "under 1e-4, 1e-2 over a bed", 0, 1e-3, "", most_saturated},
      {"Gemini", "99.9 % of the docking station over the far noise", "19", 16, 22, "dB", highlights_db},
      {"Gemini", "patches of a plain bed, middle third: variance of intensity over squared mean",
       "1.0 to 2.1", 1.0, 2.1, "", bed_index},
      {"Gemini", "near water: share of cells of clutter", "isolated", 1e-5, 1e-2, "", clutter_share},
  };
}

}  // namespace sonard::realism
