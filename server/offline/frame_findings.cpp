// SPDX-License-Identifier: Apache-2.0
#include "server/offline/frame_findings.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "common/text/counted.hpp"

namespace sonard::server {
namespace {

constexpr std::size_t few_triangles = 200'000;  // a look at every frame then costs far less than its ping

}  // namespace

FrameFindings::FrameFindings(const render::World& world, const DaemonConfig& config, std::size_t head,
                             const VehicleTrajectory& trajectory)
    : world_(world),
      config_(config),
      head_(config.heads[head]),
      trajectory_(trajectory),
      boxes_(boxes_of(world)),
      every_(1 + static_cast<int>(world.triangle_count() / few_triangles)) {}

void FrameFindings::add(const std::string& frame, const FrameView& view) {
  const render::Pose T_world_vehicle = trajectory_.T_world_vehicle(view.time_ns);
  std::vector<PosedBody> moved;
  for (const VehicleTrajectory::BodyWay& way : trajectory_.bodies()) {
    moved.push_back({way.body, way.T_world_body(view.time_ns)});
  }
  if (!trajectory_.vehicle_model().empty()) {
    moved.push_back({trajectory_.vehicle_model(), T_world_vehicle});
  }
  ++frames_;
  for (const Finding& finding : look_around(world_, boxes_, moved,
                                            {.T_world_vehicle = T_world_vehicle,
                                            .T_world_sonar = T_world_vehicle * head_.T_vehicle_sonar,
                                            .range_m = view.range_m,
                                            .sees_surface = view.sees_surface,
                                            .echo_over_floor = view.echo_over_floor,
                                            .vehicle_model = config_.world.vehicle_model,
                                            .hides_vehicle = head_.hides_vehicle})) {
    auto cause = std::ranges::find(causes_, finding.code, &Cause::code);
    if (cause == causes_.end()) {
      cause = causes_.insert(cause, {finding.code, finding.text, frame});
    }
    ++cause->frames;
  }
}

std::vector<std::string> FrameFindings::lines() const {
  std::vector<Cause> causes = causes_;
  std::ranges::stable_sort(causes, std::ranges::greater{}, &Cause::frames);
  std::vector<std::string> lines;
  for (const Cause& cause : causes) {
    lines.push_back(fmt::format("{} of {}{}: {} (first in {})", cause.frames, counted(frames_, "frame"),
                                every_ == 1 ? "" : " that were looked at", cause.text, cause.first_frame));
  }
  return lines;
}

}  // namespace sonard::server
