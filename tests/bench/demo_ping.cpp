// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/demo_ping.hpp"

#include <cstddef>
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

struct Stages {
  Timing ping_ms, visibility_ms, binning_ms, multipath_ms, reception_ms, receiver_ms;

  void add(double ping_s, const render::PingStatistics& spent) {
    ping_ms.add(ms_per_s * ping_s);
    visibility_ms.add(ms_per_s * spent.visibility_s);
    binning_ms.add(ms_per_s * spent.binning_s);
    multipath_ms.add(ms_per_s * spent.multipath_s);
    reception_ms.add(ms_per_s * (spent.azimuth_pattern_s + spent.pulse_s));
    receiver_ms.add(ms_per_s * spent.receiver_s);
  }
};

/// Poses at the start and at the end of each ping, in turns.
std::vector<render::Pose> poses_of(int pings) {
  std::vector<double> times_s;
  for (int i = 0; i < pings; ++i) {
    times_s.push_back(i * interval_s);
    times_s.push_back(i * interval_s + listening_s);
  }
  return pictures::poses_along(config, trajectory, times_s);
}

}  // namespace

void measure_demo_ping(Measurements& results, const Repetition& repetition) {
  const pictures::View view = pictures::configured_view(config, range_m);
  const std::vector<render::Pose> T_world_sonar = poses_of(warm_up_pings + repetition.most);
  render::RendererOptions options;
  options.engine = render::EngineKind::cpu;
  render::SonarRenderer renderer(view.world, options);
  Stages stages;
  double start_s = now_s();
  for (int i = 0; i < warm_up_pings || repetition.wants_more(i - warm_up_pings, start_s); ++i) {
    const auto at = static_cast<std::size_t>(i) * 2;
    const render::PingRequest request{T_world_sonar[at], view.settings, static_cast<std::uint64_t>(i), 1,
                                      T_world_sonar[at + 1]};
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

}  // namespace sonard::bench
