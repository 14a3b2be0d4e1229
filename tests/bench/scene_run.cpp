// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scene_run.hpp"

#include <cstring>

#include "tests/bench/gpu_cost.hpp"
#include "tests/bench/image_error.hpp"
#include "tests/bench/machine.hpp"

namespace sonard::bench {

namespace {

constexpr double step_between_pings_m = 1e-3;
constexpr int poses = 16;
constexpr int warm_up_pings = 3;

bool same_bits(const render::EchoImage& a, const render::EchoImage& b) {
  return a.intensity.size() == b.intensity.size() &&
         std::memcmp(a.intensity.data(), b.intensity.data(), a.intensity.size() * sizeof(float)) == 0;
}

bool has_multipath(const test::Scene& scene) {
  return scene.settings.physical.multipath.level != render::MultipathSettings::Level::off;
}

bool is_scanning(const test::Scene& scene) {
  return scene.settings.aperture.beam_count() == 1;
}

}  // namespace

void move_to_timed_pose(render::PingRequest& request, const render::Pose& start, int i) {
  request.T_world_sonar.position_m = start.position_m;
  request.T_world_sonar.position_m.x += step_between_pings_m * (1 + i % poses);
  request.ping_number = static_cast<std::uint64_t>(i);
}

SceneRun::SceneRun(const test::Scene& scene, const render::RendererOptions& options, Measurements& results,
                   bool bodies_drift)
    : scene_(scene), results_(results), renderer_(scene.world, options), bodies_drift_(bodies_drift) {}

Subject SceneRun::subject(const Point& point) const {
  return {scene_.name, std::string(render::name_of(renderer_.engine())), point.name};
}

render::PingRequest SceneRun::request(const Point& point) const {
  render::PingRequest request = scene_.request();
  point.apply(request.settings);
  return request;
}

void SceneRun::measure(const Point& point, const Reference* reference, const Repetition& repetition) {
  reset_peak_memory();
  const render::PingRequest still = request(point);
  const render::EchoImage image = renderer_.render_echo(still);
  const Stages stages = time_pings(still, repetition);
  drift(0);
  const bool repeatable = same_bits(image, renderer_.render_echo(still));
  const render::PingStatistics statistics = renderer_.last_statistics();
  const Timing unchanged_ms = time_unchanged(still, {3, repetition.most, repetition.budget_s / 4});
  add_times(subject(point), stages, unchanged_ms);
  if (statistics.gpu.passes > 0) {  // engine `gpu`
    for (const auto& [name, count] : counts_of(statistics)) {
      results_.add(subject(point), name, count, "count");
    }
    results_.add(subject(point), "video_memory",
                 static_cast<double>(statistics.gpu.video_memory_bytes) / 0x1p20, "MiB");
  } else {
    results_.add(subject(point), "samples", static_cast<double>(statistics.samples), "count");
  }
  results_.add(subject(point), "repeatable", repeatable ? 1 : 0, "1");
  results_.add(subject(point), "peak_memory", peak_memory_mib(), "MiB");
  if (reference != nullptr) {
    add_errors(results_, subject(point), point, image, *reference);
  }
}

SceneRun::Stages SceneRun::time_pings(render::PingRequest request, const Repetition& repetition) {
  const render::Pose start = request.T_world_sonar;
  const int warm_up = repetition.fewest < warm_up_pings ? 1 : warm_up_pings;
  for (int i = 0; i < warm_up; ++i) {
    move_to_timed_pose(request, start, i);
    renderer_.render_echo(request);
  }
  Stages stages;
  const double start_s = now_s();
  for (int i = 0; repetition.wants_more(i, start_s); ++i) {
    move_to_timed_pose(request, start, warm_up + i);
    const double from_s = now_s();
    drift(1 + i);
    renderer_.render_echo(request);
    const double ping_s = now_s() - from_s;
    const render::PingStatistics& spent = renderer_.last_statistics();
    stages.ping_ms.add(ms_per_s * ping_s);
    stages.visibility_ms.add(ms_per_s * spent.seconds.visibility);
    stages.binning_ms.add(ms_per_s * spent.seconds.binning);
    stages.multipath_ms.add(ms_per_s * spent.seconds.multipath);
  }
  return stages;
}

/// @param ping 0: initial poses of the bodies
void SceneRun::drift(int ping) {
  for (std::size_t i = 1; bodies_drift_ && i < scene_.world.bodies.size(); ++i) {
    const render::Body& body = scene_.world.bodies[i];
    renderer_.set_body_pose(body.name, test::drifting_pose(body.T_world_body, i, ping));
  }
}

/// @pre The last ping was this request.
Timing SceneRun::time_unchanged(const render::PingRequest& request, const Repetition& repetition) {
  Timing unchanged_ms;
  const double start_s = now_s();
  for (int i = 0; repetition.wants_more(i, start_s); ++i) {
    const double from_s = now_s();
    renderer_.render_echo(request);
    unchanged_ms.add(ms_per_s * (now_s() - from_s));
  }
  return unchanged_ms;
}

void SceneRun::measure_receiver(const Point& point, int lines, const std::string& metric,
                                const Repetition& repetition,
                                const std::function<void(render::PhysicalModel&)>& change) {
  render::PingRequest ping = request(point);
  change(ping.settings.physical);
  ping.settings.range = {lines, scene_.settings.range.max_range_m() / lines, 0, false};
  const render::Pose start = ping.T_world_sonar;
  Timing receiver_ms;
  const double start_s = now_s();
  for (int i = -warm_up_pings; i < 0 || repetition.wants_more(i, start_s); ++i) {
    move_to_timed_pose(ping, start, i + warm_up_pings);
    renderer_.render_ping(ping);
    if (i >= 0) {
      receiver_ms.add(ms_per_s * renderer_.last_statistics().seconds.receiver);
    }
  }
  results_.add(subject(point), metric, receiver_ms.median(), "ms");
  results_.add(subject(point), metric + "_p95", receiver_ms.p95(), "ms");
  results_.add(subject(point), metric + "_min", receiver_ms.min(), "ms");
}

void SceneRun::measure_reception(const Point& point, const Repetition& repetition) {
  render::PingRequest ping = request(point);
  ping.settings.aperture.azimuth = render::Aperture::Azimuth::array;
  ping.settings.aperture.element_amplitude_sd = 0.45;
  ping.settings.aperture.element_phase_sd_rad = 0.45;
  ping.settings.physical.pulse.shape = render::PulseSettings::Shape::chirp;
  ping.settings.physical.pulse.range_cell_m = ping.settings.range.step_m;
  const render::Pose start = ping.T_world_sonar;
  for (const int fine_beams : {1, 2, 3}) {
    ping.settings.aperture.fine_beams = fine_beams;
    Timing sampling_ms, pattern_ms, pulse_ms;
    const double start_s = now_s();
    for (int i = -warm_up_pings; i < 0 || repetition.wants_more(i, start_s); ++i) {
      move_to_timed_pose(ping, start, i + warm_up_pings);
      renderer_.render_echo(ping);
      if (i >= 0) {
        const render::PingStatistics& spent = renderer_.last_statistics();
        sampling_ms.add(ms_per_s * (spent.seconds.visibility + spent.seconds.binning));
        pattern_ms.add(ms_per_s * spent.seconds.azimuth_pattern);
        pulse_ms.add(ms_per_s * spent.seconds.pulse);
      }
    }
    const std::string metric = "fine_beams_" + std::to_string(fine_beams) + "_ms";
    results_.add(subject(point), "sampling_" + metric, sampling_ms.median(), "ms");
    results_.add(subject(point), "pattern_" + metric, pattern_ms.median(), "ms");
    if (fine_beams == render::Aperture{}.fine_beams) {
      results_.add(subject(point), "azimuth_pattern_ms", pattern_ms.median(), "ms");
      results_.add(subject(point), "azimuth_pattern_ms_min", pattern_ms.min(), "ms");
      results_.add(subject(point), "pulse_ms", pulse_ms.median(), "ms");
      results_.add(subject(point), "pulse_ms_min", pulse_ms.min(), "ms");
    }
  }
}

void SceneRun::add_times(const Subject& subject, const Stages& stages, const Timing& unchanged_ms) {
  results_.add(subject, "ping_ms", stages.ping_ms.median(), "ms");
  results_.add(subject, "ping_ms_p95", stages.ping_ms.p95(), "ms");
  results_.add(subject, "ping_ms_min", stages.ping_ms.min(), "ms");
  results_.add(subject, "visibility_ms", stages.visibility_ms.median(), "ms");
  results_.add(subject, "binning_ms", stages.binning_ms.median(), "ms");
  if (has_multipath(scene_)) {
    results_.add(subject, "multipath_ms", stages.multipath_ms.median(), "ms");
  }
  results_.add(subject, "unchanged_ms", unchanged_ms.median(), "ms");
  results_.add(subject, "ping_over_visibility", stages.ping_ms.median() / stages.visibility_ms.median(), "1");
  results_.add(subject, "unchanged_over_ping", unchanged_ms.median() / stages.ping_ms.median(), "1");
  if (is_scanning(scene_)) {
    results_.add(subject, "msis_ping_ms", stages.ping_ms.median(), "ms");
  }
}

void add_errors(Measurements& results, const Subject& subject, const Point& point,
                const render::EchoImage& image, const Reference& reference) {
  const std::optional<ImageError> error = compare_images(image, reference.image);
  if (!error) {
    return;  // there is no echo
  }
  results.add(subject, "hole_fraction", error->hole_fraction, "1");
  results.add(subject, "hole_fraction_60db", error->hole_fraction_60db, "1");
  if (!point.energy) {
    return;
  }
  results.add(subject, "bin_rms", error->bin_rms, "1");
  results.add(subject, "bin_rms_trim", error->bin_rms_trim, "1");
  results.add(subject, "first_echo_bins", error->first_echo_bins, "bins");
  results.add(subject, "beam_total_mean", error->beam_total_mean, "1");
  results.add(subject, "beam_total_worst", error->beam_total_worst, "1");
  if (reference.error_rms) {
    results.add(subject, "reference_rms", *reference.error_rms, "1");
  }
}

}  // namespace sonard::bench
