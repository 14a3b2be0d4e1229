// SPDX-License-Identifier: Apache-2.0
#include "server/trial_pings.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "renderer/usable_cores.hpp"
#include "server/clock/clock.hpp"
#include "server/daemon/daemon.hpp"
#include "server/devices/device_type.hpp"
#include "server/diagnosis/view.hpp"

namespace sonard::server {
namespace {

render::RendererOptions cpu_options(const DaemonConfig& config) {
  render::RendererOptions options = renderer_options(config);
  options.engine = render::EngineKind::cpu;
  return options;
}

constexpr int bearings = 12;  // of a scanning head

/// The vehicle's own model at the vehicle's pose; empty without a model.
std::vector<PosedBody> own_model(const DaemonConfig& config, const render::Pose& T_world_vehicle) {
  std::vector<PosedBody> bodies;
  if (!config.world.vehicle_model.empty()) {
    bodies.push_back({config.world.vehicle_model, T_world_vehicle});
  }
  return bodies;
}

}  // namespace

TrialPings::TrialPings(const DaemonConfig& config, const render::World& world)
    : config_(config), world_(world), boxes_(boxes_of(world)), renderer_(world, cpu_options(config)) {}

void TrialPings::move_bodies(const std::vector<PosedBody>& moved) {
  for (const PosedBody& body : moved) {
    renderer_.set_body_pose(body.name, body.T_world_body);
  }
}

double TrialPings::cost_ms(std::size_t head, render::Pose T_world_vehicle) {
  constexpr int most = 3;
  constexpr double long_ms = 2000.0;  // one ping that takes longer is enough
  double least_ms = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most && (i == 0 || least_ms < long_ms); ++i) {
    T_world_vehicle.position_m.x += 1e-3;  // a small step, because an unchanged world is not traced again
    move_bodies(own_model(config_, T_world_vehicle));
    const ProcessorTime before = processor_time();
    renderer_.render_ping(usual_ping(config_.heads[head], T_world_vehicle), static_cast<int>(head));
    const ProcessorTime after = processor_time();
    // This thread takes part in all the work. If other threads were held up, it did more; if it was held up,
    // they did more.
    const auto share = (after.process - before.process) / render::usable_cores();
    const std::chrono::duration<double, std::milli> cost = std::max(after.thread - before.thread, share);
    least_ms = std::min(least_ms, cost.count());
  }
  return least_ms;
}

std::vector<Finding> TrialPings::ping(std::size_t head, const render::Pose& T_world_vehicle,
                                      std::vector<PosedBody> moved) {
  const HeadConfig& settings = config_.heads[head];
  std::ranges::copy(own_model(config_, T_world_vehicle), std::back_inserter(moved));
  move_bodies(moved);
  const render::PingRequest ahead = usual_ping(settings, T_world_vehicle);
  renderer_.render_ping(ahead, static_cast<int>(head));
  render::PingStatistics seen = renderer_.last_statistics();
  for (int i = 1; type_of(settings).turns() && i < bearings; ++i) {
    render::PingRequest turned = ahead;
    turned.T_world_sonar = T_world_transducer(ahead.T_world_sonar, 2.0 * std::numbers::pi * i / bearings);
    renderer_.render_ping(turned, static_cast<int>(head));
    const render::PingStatistics& there = renderer_.last_statistics();
    seen.sees_surface = seen.sees_surface || there.sees_surface;
    seen.echo_over_floor = std::max(seen.echo_over_floor, there.echo_over_floor);
  }
  return look_around(world_, boxes_, moved,
                     {.T_world_vehicle = T_world_vehicle,
                      .T_world_sonar = T_world_vehicle * settings.T_vehicle_sonar,
                      .range_m = usual_settings(settings).range.max_range_m(),
                      .sees_surface = seen.sees_surface,
                      .echo_over_floor = seen.echo_over_floor,
                      .vehicle_model = config_.world.vehicle_model,
                      .hides_vehicle = settings.hides_vehicle});
}

std::string TrialPings::view(std::size_t head, const std::optional<render::Pose>& T_world_vehicle,
                             const std::vector<PosedBody>& moved) const {
  const HeadConfig& settings = config_.heads[head];
  const std::string looks = fmt::format("{}{}", type_of(settings).turns() ? "turns, and ahead is " : "",
                                        looks_text(settings.T_vehicle_sonar));
  if (!T_world_vehicle) {
    return looks;
  }
  const render::SonarSettings usual = usual_settings(settings);
  return fmt::format("{}; {}", looks,
                     bed_text(view_of_bed(world_, moved, config_.world.vehicle_model,
                                          *T_world_vehicle * settings.T_vehicle_sonar, usual.aperture,
                                          usual.range.max_range_m()),
                              usual.range.max_range_m()));
}

}  // namespace sonard::server
