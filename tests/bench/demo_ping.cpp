// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/demo_ping.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/pictures/view.hpp"

namespace sonard::bench {
namespace {

constexpr const char* config = "demo.yaml";
constexpr const char* trajectory = "trajectories/docking_demo.csv";
constexpr double range_m = 20;
constexpr double interval_s = 0.06;    // of the demo's client
constexpr double listening_s = 0.027;  // until the echo from 20 m is back
constexpr int warm_up_pings = 3;
constexpr double trajectory_s = 80;

render::RendererOptions on_cpu() {
  render::RendererOptions options;
  options.engine = render::EngineKind::cpu;
  return options;
}

struct Stages {
  Timing ping_ms, visibility_ms, binning_ms, multipath_ms, reception_ms, receiver_ms;

  void add(double ping_s, const render::PingStatistics& spent) {
    ping_ms.add(ms_per_s * ping_s);
    visibility_ms.add(ms_per_s * spent.seconds.visibility);
    binning_ms.add(ms_per_s * spent.seconds.binning);
    multipath_ms.add(ms_per_s * spent.seconds.multipath);
    reception_ms.add(ms_per_s * (spent.seconds.azimuth_pattern + spent.seconds.pulse));
    receiver_ms.add(ms_per_s * spent.seconds.receiver);
  }
};

/// Poses at the start and at the end of each ping, in turns.
std::vector<render::Pose> poses_of(int pings, double each_s) {
  std::vector<double> times_s;
  for (int i = 0; i < pings; ++i) {
    times_s.push_back(i * each_s);
    times_s.push_back(i * each_s + listening_s);
  }
  return pictures::poses_along(config, trajectory, times_s);
}

render::PingRequest request_of(const std::vector<render::Pose>& T_world_sonar, int ping,
                               const render::SonarSettings& settings) {
  const auto at = static_cast<std::size_t>(ping) * 2;
  return {T_world_sonar[at], settings, static_cast<std::uint64_t>(ping), 1, T_world_sonar[at + 1]};
}

/// Renders pings and times those after the first warm_up_pings.
void time_pings(Measurements& results, const pictures::View& view,
                const std::vector<render::Pose>& T_world_sonar, const Repetition& repetition) {
  render::SonarRenderer renderer(view.world, on_cpu());
  Stages stages;
  double start_s = now_s();
  for (int i = 0; i < warm_up_pings || repetition.wants_more(i - warm_up_pings, start_s); ++i) {
    const render::PingRequest request = request_of(T_world_sonar, i, view.settings);
    if (i == warm_up_pings) {
      start_s = now_s();
    }
    const double from_s = now_s();
    renderer.render_ping(request);
    if (i >= warm_up_pings) {
      stages.add(now_s() - from_s, renderer.last_statistics());
    }
  }
  for (const auto& [metric, timing] : {std::pair<std::string, const Timing&>{"ping_ms", stages.ping_ms},
                                       {"visibility_ms", stages.visibility_ms},
                                       {"binning_ms", stages.binning_ms},
                                       {"multipath_ms", stages.multipath_ms},
                                       {"reception_ms", stages.reception_ms},
                                       {"receiver_ms", stages.receiver_ms}}) {
    results.add(demo_ping, metric, timing.median(), "ms");
    results.add(demo_ping, metric + "_min", timing.min(), "ms");
  }
}

/// Samples of the pings at these poses with a preset, one ping after the other.
std::vector<std::uint8_t> samples_with(render::Sampling::Preset preset, const pictures::View& view,
                                       const std::vector<render::Pose>& T_world_sonar) {
  render::SonarSettings settings = view.settings;
  settings.sampling.preset = preset;
  render::SonarRenderer renderer(view.world, on_cpu());
  std::vector<std::uint8_t> samples;
  for (int i = 0; i < static_cast<int>(T_world_sonar.size() / 2); ++i) {
    const render::PingSamples ping = renderer.render_ping(request_of(T_world_sonar, i, settings));
    samples.insert(samples.end(), ping.u8.begin(), ping.u8.end());
  }
  return samples;
}

/// Speckle and noise have the same seeds in all presets, so that only errors of the echo make a difference.
void compare_samples(Measurements& results, const pictures::View& view,
                     const std::vector<render::Pose>& T_world_sonar) {
  using Preset = render::Sampling::Preset;
  const std::vector<std::uint8_t> exact = samples_with(Preset::reference, view, T_world_sonar);
  for (const auto& [name, preset] : {std::pair{"fast", Preset::fast}, {"default", Preset::normal}}) {
    const std::vector<std::uint8_t> samples = samples_with(preset, view, T_world_sonar);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      differing += std::abs(samples[i] - exact[i]) > 1 ? 1U : 0U;
    }
    results.add({demo_ping.scene, demo_ping.engine, name}, "differing_samples",
                static_cast<double>(differing) / static_cast<double>(exact.size()), "1");
  }
}

}  // namespace

void measure_demo_ping(Measurements& results, const Repetition& repetition, int compared_pings) {
  const pictures::View view = pictures::configured_view(config, range_m);
  const std::vector<render::Pose> timed = poses_of(warm_up_pings + repetition.most, interval_s);
  const std::vector<render::Pose> compared =
      poses_of(compared_pings, trajectory_s / std::max(1, compared_pings));
  time_pings(results, view, timed, repetition);
  if (compared_pings > 0) {
    compare_samples(results, view, compared);
  }
}

}  // namespace sonard::bench
