// SPDX-License-Identifier: Apache-2.0
#include "server/trial_pings.hpp"

#include <algorithm>
#include <chrono>

#include "renderer/usable_cores.hpp"
#include "server/clock/clock.hpp"
#include "server/daemon/daemon.hpp"
#include "server/devices/device_kind.hpp"

namespace sonard::server {
namespace {

render::RendererOptions cpu_options(const DaemonConfig& config) {
  render::RendererOptions options = renderer_options(config);
  options.engine = render::EngineKind::cpu;
  return options;
}

}  // namespace

TrialPings::TrialPings(const DaemonConfig& config, const render::World& world)
    : config_(config), world_(world), boxes_(boxes_of(world)), renderer_(world, cpu_options(config)) {}

std::vector<Finding> TrialPings::ping(std::size_t head, const render::Pose& T_world_vehicle,
                                      std::vector<PosedBody> moved) {
  const HeadConfig& settings = config_.heads[head];
  if (!config_.vehicle_model.empty()) {
    moved.push_back({config_.vehicle_model, T_world_vehicle});
  }
  for (const PosedBody& body : moved) {
    renderer_.set_body_pose(body.name, body.T_world_body);
  }
  const ProcessorTime before = processor_time();
  renderer_.render_ping(usual_ping(settings, T_world_vehicle), static_cast<int>(head));
  const ProcessorTime after = processor_time();
  // This thread has a part in all the work; where others were held up it did more, and where it was, they
  // did.
  const auto share = (after.process - before.process) / render::usable_cores();
  last_ms_ = std::chrono::duration<double, std::milli>(std::max(after.thread - before.thread, share)).count();
  return look_around(world_, boxes_, moved,
                     {.T_world_vehicle = T_world_vehicle,
                      .T_world_sonar = T_world_vehicle * settings.T_vehicle_sonar,
                      .range_m = usual_settings(settings).range.sampled_range_m(),
                      .sees_surface = renderer_.last_statistics().sees_surface,
                      .vehicle_model = config_.vehicle_model,
                      .hides_vehicle = settings.hides_vehicle});
}

}  // namespace sonard::server
