// SPDX-License-Identifier: Apache-2.0
// Measures time against error of the CPU engine over scenes and poses, for its presets and for parameter sets
// drawn around them (docs/benchmark.md, "Presets"). The truth of each image is preset `reference` at that
// pose.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "renderer/binning/binning.hpp"
#include "renderer/engine.hpp"
#include "renderer/engines/cpu/slice_binner.hpp"
#include "renderer/engines/cpu/slice_sampler.hpp"
#include "renderer/engines/slices/slice_accuracy.hpp"
#include "renderer/surface/surface_model.hpp"
#include "renderer/worker_pool.hpp"
#include "tests/bench/image_error.hpp"
#include "tests/scenes/scenes.hpp"

namespace {

using namespace sonard;
using nlohmann::ordered_json;
using render::SliceAccuracy;
using Preset = render::Sampling::Preset;

constexpr double moved_m = 1.5;
constexpr double turned_rad = 20.0 * std::numbers::pi / 180.0;
constexpr double ms_per_s = 1e3;

struct Candidate {
  std::string name;
  SliceAccuracy accuracy;
};

/// CPU time of this thread, which renders alone.
double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The scene's pose, moved and turned; number 0 is the pose itself.
render::Pose pose_near(const render::Pose& start, int number) {
  if (number == 0) {
    return start;
  }
  std::mt19937 random(static_cast<unsigned>(number));
  const auto within = [&](double limit) {
    return limit * (2.0 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 1.0);
  };
  render::Pose pose = start;
  pose.position_m += glm::dvec3(within(moved_m), within(moved_m), 0.3 * within(moved_m));
  const double yaw = within(turned_rad), pitch = 0.3 * within(turned_rad), roll = 0.3 * within(turned_rad);
  pose.orientation =
      glm::normalize(glm::angleAxis(yaw, glm::dvec3(0, 0, 1)) * pose.orientation *
                     glm::angleAxis(pitch, glm::dvec3(0, 1, 0)) * glm::angleAxis(roll, glm::dvec3(1, 0, 0)));
  return pose;
}

/// One scene, rendered on this thread with any accuracy.
class SceneBench {
 public:
  explicit SceneBench(test::Scene scene)
      : scene_(std::move(scene)),
        slices_(scene_.world, workers_),
        largest_response_(render::largest_response(scene_.world)) {}

  const std::string& name() const { return scene_.name; }

  /// Renders an image and adds its CPU time to `seconds`.
  render::EchoImage image(int pose, const SliceAccuracy& accuracy, double& seconds) {
    const render::SonarSettings& settings = scene_.settings;
    const render::EchoRequest request{pose_near(scene_.T_world_sonar, pose), settings};
    const double begin = cpu_s();
    const auto cells =
        slices_.sample(request.T_world_sonar, settings.aperture, settings.range,
                       settings.range.sampled_range_m(), render::surface_model(settings, skip_), accuracy);
    render::BinningResult bins =
        render::bin_echoes(slices_, cells, settings.aperture, settings.range,
                           render::binning_options(request, skip_, largest_response_), workers_, {});
    seconds += cpu_s() - begin;
    render::EchoImage image;
    image.beams = bins.beams;
    image.bins = bins.lines;
    image.intensity = std::move(bins.echo);
    return image;
  }

 private:
  test::Scene scene_;
  render::SkipSwitches skip_;
  render::WorkerPool workers_{1};
  render::SliceSampler slices_;
  float largest_response_;
};

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  std::ranges::sort(values);
  const auto index = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  return values[std::min(index, values.size() - 1)];
}

/// Errors over all poses of a scene.
class PooledError {
 public:
  void add(const render::EchoImage& image, const render::EchoImage& truth) {
    const auto error = bench::compare_images(image, truth);
    if (!error) {
      return;
    }
    squares_ += error->bin_rms * error->bin_rms * static_cast<double>(error->bins);
    holes_ += error->hole_fraction * static_cast<double>(error->bins);
    bins_ += static_cast<double>(error->bins);
    for (const bench::BeamError& beam : bench::compare_beams(image, truth)) {
      totals_.push_back(beam.total);
      // A beam without an echo has no centroid.
      centroids_.push_back(std::isnan(beam.centroid_lines) ? std::numeric_limits<double>::infinity()
                                                           : beam.centroid_lines);
      first_echoes_.push_back(beam.first_echo_lines);
    }
  }

  void write(ordered_json& row) {
    row["bin_rms"] = bins_ > 0 ? std::sqrt(squares_ / bins_) : 0.0;
    row["holes"] = bins_ > 0 ? holes_ / bins_ : 0.0;
    for (auto& [name, values] : {std::pair{"total", &totals_},
                                 {"centroid_lines", &centroids_},
                                 {"first_echo_lines", &first_echoes_}}) {
      row[fmt::format("{}_p99", name)] = quantile(*values, 0.99);
      row[fmt::format("{}_worst", name)] = quantile(*values, 1.0);
    }
  }

 private:
  double squares_ = 0.0, holes_ = 0.0, bins_ = 0.0;
  std::vector<double> totals_, centroids_, first_echoes_;
};

/// `presets`, and sets drawn around the line from `default` to beyond `fast`, in logarithms of the
/// parameters.
std::vector<Candidate> candidates(int drawn, unsigned seed) {
  const SliceAccuracy exact = render::slice_accuracy({Preset::normal}, render::Model::physical);
  const SliceAccuracy coarse = render::slice_accuracy({Preset::fast}, render::Model::physical);
  std::vector<Candidate> all{{"default", exact}, {"fast", coarse}};
  std::mt19937 random(seed);
  for (int k = 0; k < drawn; ++k) {
    const double along = std::uniform_real_distribution<double>(-0.3, 2.0)(random);
    const auto between = [&](float from, float to) {
      const double t = along + std::normal_distribution<double>(0.0, 0.35)(random);
      return from * static_cast<float>(std::pow(static_cast<double>(to / from), t));
    };
    constexpr std::array divisions{3, 5, 9, 15, 25, 45, 75, 125};
    SliceAccuracy set = exact;
    const double rank = std::normal_distribution<double>(6.5 - 3.0 * along, 1.5)(random);
    set.most_divisions = divisions.at(static_cast<std::size_t>(std::clamp(rank, 0.0, 7.0)));
    set.disagreement = between(exact.disagreement, coarse.disagreement);
    set.shift_lines = between(exact.shift_lines, coarse.shift_lines);
    set.sagitta_lines = between(exact.sagitta_lines, coarse.sagitta_lines);
    set.linearity = between(exact.linearity, coarse.linearity);
    set.change = between(exact.change, coarse.change);
    set.mapped_lines = between(exact.mapped_lines, coarse.mapped_lines);
    set.facet_slopes = between(exact.facet_slopes, coarse.facet_slopes);
    set.facet_lines = between(exact.facet_lines, coarse.facet_lines);
    all.push_back({fmt::format("drawn_{}", k), set});
  }
  return all;
}

ordered_json parameters(const SliceAccuracy& set) {
  return {{"most_divisions", set.most_divisions},
          {"most_divisions_of_lone_echoes", set.most_divisions_of_lone_echoes},
          {"disagreement", set.disagreement},
          {"shift_lines", set.shift_lines},
          {"sagitta_lines", set.sagitta_lines},
          {"linearity", set.linearity},
          {"change", set.change},
          {"mapped_lines", set.mapped_lines},
          {"facet_slopes", set.facet_slopes},
          {"facet_lines", set.facet_lines}};
}

SliceAccuracy accuracy_of(const nlohmann::json& row) {
  SliceAccuracy set;
  const auto read = [&](const char* key, auto& value) { row.at(key).get_to(value); };
  read("most_divisions", set.most_divisions);
  read("most_divisions_of_lone_echoes", set.most_divisions_of_lone_echoes);
  read("disagreement", set.disagreement);
  read("shift_lines", set.shift_lines);
  read("sagitta_lines", set.sagitta_lines);
  read("linearity", set.linearity);
  read("change", set.change);
  read("mapped_lines", set.mapped_lines);
  read("facet_slopes", set.facet_slopes);
  read("facet_lines", set.facet_lines);
  return set;
}

struct Options {
  std::vector<std::string> scenes{"plane",           "b1_wall",    "b2_seabed_2m", "b2_seabed_5m",
                                  "b5_tank",         "b7_pipes",   "flat100k",     "swell100k",
                                  "ripple100k",      "b3_cluster", "docking",      "docking_demo",
                                  "b4_manifold_1e5", "msis_swell", "msis_ripple"};
  int first_pose = 0;
  int poses = 12;
  int drawn = 0;
  unsigned seed = 1;
  std::string sets, json = "tune.json";
};

/// Measures all candidates in one scene; one row for each.
void run_scene(const Options& options, const std::vector<Candidate>& all, const std::string& name,
               ordered_json& rows) {
  SceneBench scene(test::make_scene(name));
  const SliceAccuracy exact = render::slice_accuracy({Preset::reference}, render::Model::physical);
  std::vector<render::EchoImage> truths;
  double spent = 0.0;
  for (int pose = 0; pose < options.poses; ++pose) {
    truths.push_back(scene.image(options.first_pose + pose, exact, spent));
  }
  std::cerr << fmt::format("{}: reference takes {:.0f} ms\n", name, spent / options.poses * ms_per_s);
  for (const Candidate& candidate : all) {
    PooledError error;
    double seconds = 0.0;
    for (int pose = 0; pose < options.poses; ++pose) {
      error.add(scene.image(options.first_pose + pose, candidate.accuracy, seconds),
                truths[static_cast<std::size_t>(pose)]);
    }
    ordered_json row{
        {"set", candidate.name}, {"scene", name}, {"cpu_ms", seconds / options.poses * ms_per_s}};
    error.write(row);
    row["parameters"] = parameters(candidate.accuracy);
    rows.push_back(std::move(row));
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Renders scenes at many poses with the presets and with drawn sets of parameters; writes time and "
      "error."};
  app.add_option("--scenes", options.scenes, "scenes of sonard_bench")->capture_default_str()->delimiter(',');
  app.add_option("--first-pose", options.first_pose, "number of the first pose; 0 is the scene's own");
  app.add_option("--poses", options.poses, "how many poses of each scene")->capture_default_str();
  app.add_option("--drawn", options.drawn, "how many sets of parameters to draw")->capture_default_str();
  app.add_option("--seed", options.seed, "of the draw")->capture_default_str();
  app.add_option("--sets", options.sets, "a JSON list of {name, parameters} to measure, too");
  app.add_option("--json", options.json, "file to write")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::vector<Candidate> all = candidates(options.drawn, options.seed);
  if (!options.sets.empty()) {
    for (const auto& set : nlohmann::json::parse(std::ifstream(options.sets))) {
      all.push_back({set.at("name"), accuracy_of(set.at("parameters"))});
    }
  }
  ordered_json rows = ordered_json::array();
  for (const std::string& scene : options.scenes) {
    run_scene(options, all, scene, rows);
    std::ofstream(options.json) << rows.dump(1) << '\n';
  }
  return 0;
}
