// SPDX-License-Identifier: Apache-2.0
// sonard_oracle: renders the references of tests/data/oracle.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "tests/oracle/bvh.hpp"
#include "tests/oracle/ray_integrator.hpp"
#include "tests/oracle/reference.hpp"
#include "tests/oracle/scene_hash.hpp"
#include "tests/oracle/slice_integrator.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::oracle {

namespace {

struct RenderCommand {
  std::vector<std::string> scenes;
  std::filesystem::path folder = SONARD_SOURCE_DIR "/tests/data/oracle";
  SliceOptions slices{.error_rms = 1e-5,
                      .error_max = 1e-4,
                      .max_slices_per_beam = 65536,
                      .first_intervals = 32,
                      .max_corners = 512};
  int ray_check_stride = 16;
};

RelativeError larger(const RelativeError& a, const RelativeError& b) {
  return {std::max(a.rms, b.rms), std::max(a.max, b.max)};
}

/// Every `stride`-th beam, from the middle of the first stride, so that both edges of the fan are treated
/// alike.
std::vector<int> every(int stride, int beams) {
  std::vector<int> chosen;
  for (int beam = stride / 2; beam < beams; beam += stride) {
    chosen.push_back(beam);
  }
  return chosen.empty() ? std::vector<int>{0} : chosen;
}

/// A copy in which only the beams of `chosen` are not 0.
EchoTruth only(const EchoTruth& truth, const std::vector<int>& chosen) {
  EchoTruth result = truth;
  result.echo.assign(truth.echo.size(), 0.0);
  for (const int beam : chosen) {
    const auto begin = static_cast<std::ptrdiff_t>(beam) * truth.lines;
    std::copy_n(truth.echo.begin() + begin, truth.lines, result.echo.begin() + begin);
  }
  return result;
}

void check_with_rays(const Facets& facets, const EchoLaw& law, const EchoTruth& truth, Reference& reference) {
  RayOptions options{.columns = 8, .rows = 2048, .doublings = 1, .error_rms = 0, .error_max = 0};
  options.beams = every(reference.ray_check_stride, truth.beams);
  const EchoTruth rays = integrate_rays(Bvh(facets), law, options);
  reference.ray_error = estimated_error(rays);
  reference.ray_check = difference(rays, only(truth, options.beams));
}

Reference render(const std::string& name, const RenderCommand& command) {
  const test::Scene scene = test::make_scene(name);
  const EchoLaw law(scene.settings);
  const Facets facets(scene.world, scene.T_world_sonar, law);
  const EchoTruth truth = integrate_slices(facets, law, command.slices);

  // The second run divides each beam differently, so that no slice is repeated. It may find what the first
  // run missed.
  SliceOptions second = command.slices;
  second.first_intervals = 3 * second.first_intervals / 2 + 1;
  const EchoTruth again = integrate_slices(facets, law, second);
  const EchoTruth centred = integrate_slices(facets, law.with_loss_at_line_centre(), command.slices);

  Reference reference;
  reference.scene = name;
  reference.scene_sha256 = scene_hash(scene.world, scene.T_world_sonar, scene.settings);
  reference.slices = truth.rays;
  reference.error = larger(estimated_error(truth), difference(again, truth));
  reference.line_centre = difference(centred, truth);
  reference.ray_check_stride = command.ray_check_stride;
  if (command.ray_check_stride > 0) {
    check_with_rays(facets, law, truth, reference);
  }
  reference.command = fmt::format(
      "sonard_oracle {} --error-rms {:g} --error-max {:g} --intervals {} --corners {} --ray-check {}", name,
      command.slices.error_rms, command.slices.error_max, command.slices.first_intervals,
      command.slices.max_corners, command.ray_check_stride);
  reference.beams = truth.beams;
  reference.lines = truth.lines;
  reference.echo.assign(truth.echo.begin(), truth.echo.end());
  return reference;
}

int run(int argc, char** argv) {
  RenderCommand command;
  CLI::App app("Renders the reference images that tests and the benchmark compare with.");
  app.add_option("scene", command.scenes, "names of scenes; see sonard_bench --help")->required();
  app.add_option("--out", command.folder, "folder of NAME.npy and NAME.json")->capture_default_str();
  app.add_option("--error-rms", command.slices.error_rms, "stop refining a beam below this pooled error")
      ->capture_default_str();
  app.add_option("--error-max", command.slices.error_max, "and below this error of every bin")
      ->capture_default_str();
  app.add_option("--intervals", command.slices.first_intervals,
                 "first division of a beam of half a degree: finer than the smallest thing")
      ->capture_default_str();
  app.add_option("--corners", command.slices.max_corners, "divide a beam at its corners if they are no more")
      ->capture_default_str();
  app.add_option("--max-slices", command.slices.max_slices_per_beam, "or at this many slices")
      ->capture_default_str();
  app.add_option("--ray-check", command.ray_check_stride, "compare every so many beams with rays; 0: none")
      ->capture_default_str();
  app.add_option("--threads", command.slices.threads, "0: one per core")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  for (const std::string& name : command.scenes) {
    const auto start = std::chrono::steady_clock::now();
    const Reference r = render(name, command);
    write_reference(command.folder, r);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    fmt::print(
        "{}: {} slices, error rms {:.1e} max {:.1e}, rays differ by rms {:.1e} max {:.1e} (claim {:.1e}, "
        "{:.1e}), {:.1f} s\n",
        name, r.slices, r.error.rms, r.error.max, r.ray_check.rms, r.ray_check.max, r.ray_error.rms,
        r.ray_error.max, seconds.count());
  }
  return 0;
}

}  // namespace

}  // namespace sonard::oracle

int main(int argc, char** argv) {
  try {
    return sonard::oracle::run(argc, argv);
  } catch (const std::exception& problem) {
    fmt::print(stderr, "sonard_oracle: {}\n", problem.what());
    return 1;
  }
}
