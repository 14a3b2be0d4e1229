// SPDX-License-Identifier: Apache-2.0
#include "renderer/pipeline/engine_trial.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "renderer/engines/gpu/gl_devices.hpp"
#include "renderer/errors.hpp"
#include "renderer/pipeline/image_difference.hpp"
#include "renderer/stopwatch.hpp"

namespace sonard::render {

namespace {

constexpr int most_rounds = 6;
constexpr double longest_trial_s = 0.25;  // per engine; a started round is finished
constexpr double step_m = 1e-3;           // from round to round, so that no round can reuse another
constexpr int fewest_beams_of_fan = 32;
constexpr double kept_share = 0.99;  // of the bins; a few bins at edges differ more

/// Twice the error of docs/accuracy.md for the bins, because either image may have this error.
double most_difference(const SonarSettings& settings) {
  const Sampling::Preset preset = settings.sampling.preset;
  return preset == Sampling::Preset::normal || preset == Sampling::Preset::reference ? 0.02 : 0.10;
}

struct Rounds {
  double fastest_ms = std::numeric_limits<double>::infinity();
  std::vector<EchoImage> images;  ///< of the first round
  bool all_drawn = true;          ///< by the GPU
};

/// @param away distance from the position of the first round, in steps
Rounds render_rounds(SonarRenderer& renderer, std::span<const HeadRequest> pings, int most, int away = 0) {
  Rounds rounds;
  double taken_s = 0.0;
  for (int round = 0; round < most && taken_s < longest_trial_s; ++round) {
    Stopwatch watch;
    for (HeadRequest ping : pings) {
      ping.request.T_world_sonar.position_m.x += (away + round) * step_m;
      const EchoImage& image = renderer.render_echo(ping.request, ping.head);
      if (round == 0) {
        rounds.images.push_back(image);
      }
      rounds.all_drawn = rounds.all_drawn && renderer.last_statistics().gpu.passes > 0;
    }
    const double round_s = watch.lap();
    taken_s += round_s;
    rounds.fastest_ms = std::min(rounds.fastest_ms, 1e3 * round_s / static_cast<double>(pings.size()));
  }
  return rounds;
}

/// The middle sixteenth of the beams of each fan. They take less time than all beams.
std::vector<HeadRequest> middle_beams(std::span<const HeadRequest> pings) {
  std::vector<HeadRequest> few(pings.begin(), pings.end());
  for (HeadRequest& ping : few) {
    std::vector<double>& edges_rad = ping.request.settings.aperture.beam_edges_rad;
    const auto beams = static_cast<std::ptrdiff_t>(edges_rad.size()) - 1;
    const std::ptrdiff_t kept = (beams + 15) / 16;
    const auto first = edges_rad.begin() + (beams - kept) / 2;
    edges_rad = {first, first + kept + 1};
  }
  return few;
}

/// Times the GPU and fills in the results.
void try_gpu(SonarRenderer& renderer, std::span<const HeadRequest> pings, const Rounds& by_cpu,
             EngineTrial& trial) {
  renderer.use_engine(EngineKind::gpu);
  trial.gpu = renderer.engine_description();
  const auto rounds = [&](std::span<const HeadRequest> of, int most, int away = 0) {
    Rounds made = render_rounds(renderer, of, most, away);
    trial.gpu_ms = made.fastest_ms;
    if (!made.all_drawn) {
      throw RendererError("but the CPU had to render a ping: " + renderer.engine_description());
    }
    return made;
  };
  const std::vector<HeadRequest> few = middle_beams(pings);
  // At the first draw, the driver builds shaders and the world is uploaded, which takes half a second. Later
  // pings do not need this, so the first round does not count.
  rounds(few, 1, most_rounds);
  if (pings.front().request.settings.aperture.beam_count() >= fewest_beams_of_fan) {
    rounds(few, 2);
    if (trial.gpu_ms > trial.cpu_ms) {
      trial.gpu_problem = "for only one beam in sixteen";
      return;
    }
  }
  const Rounds by_gpu = rounds(pings, most_rounds);
  for (std::size_t i = 0; i < pings.size(); ++i) {
    const double most = most_difference(pings[i].request.settings);
    trial.difference = std::max(trial.difference, bin_rms(by_gpu.images[i], by_cpu.images[i], kept_share));
    if (!(trial.difference <= most)) {
      trial.gpu_problem = fmt::format("but its image differs by {:.2g} % RMS, and the preset allows {:.2g} %",
                                      100 * trial.difference, 100 * most);
    }
  }
}

}  // namespace

EngineTrial choose_engine(SonarRenderer& renderer, std::span<const HeadRequest> first_pings) {
  EngineTrial trial;
  renderer.use_engine(EngineKind::cpu);
  trial.cpu = renderer.engine_description();
  const Rounds by_cpu = render_rounds(renderer, first_pings, most_rounds);
  trial.cpu_ms = by_cpu.fastest_ms;
  try {
    try_gpu(renderer, first_pings, by_cpu, trial);
  } catch (const RendererError& error) {
    trial.gpu_problem = error.what();
  }
  if (trial.gpu_problem.empty() && trial.gpu_ms < trial.cpu_ms) {
    trial.taken = EngineKind::gpu;
  } else {
    renderer.use_engine(EngineKind::cpu);
  }
  return trial;
}

EngineTrial choose_engine_at_start(SonarRenderer& renderer, std::span<const HeadRequest> first_pings,
                                   const GpuOptions& gpu) {
  std::string software = software_gl(gpu.device);
  if (software.empty()) {
    return choose_engine(renderer, first_pings);
  }
  EngineTrial trial;
  renderer.use_engine(EngineKind::cpu);
  trial.cpu = renderer.engine_description();
  trial.software_gl = std::move(software);
  return trial;
}

std::string describe(const EngineTrial& trial) {
  if (!trial.software_gl.empty()) {
    return fmt::format(
        "cpu is taken ({}): OpenGL runs in software here ({}) and is not timed; to use it, set engine: gpu",
        trial.cpu, trial.software_gl);
  }
  const std::string cpu = fmt::format("cpu takes {:.1f} ms per ping ({})", trial.cpu_ms, trial.cpu);
  const std::string gpu =
      trial.gpu.empty() ? "gpu is not available: " + trial.gpu_problem
                        : fmt::format("gpu {:.1f} ms{}{} ({})", trial.gpu_ms,
                                      trial.gpu_problem.empty() ? "" : " ", trial.gpu_problem, trial.gpu);
  return fmt::format("{}, {}; {} is taken", cpu, gpu, name_of(trial.taken));
}

}  // namespace sonard::render
