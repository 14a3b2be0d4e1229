// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/view.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>

#include "protocol/gemini/ping_job.hpp"
#include "protocol/micron/micron_job.hpp"
#include "protocol/micron/units.hpp"
#include "protocol/pose/trajectory.hpp"
#include "server/config/loader.hpp"
#include "server/devices/gemini_settings.hpp"
#include "server/devices/micron_settings.hpp"

namespace sonard::pictures {
namespace {

constexpr double line_rate_hz = 90'422;  // of a Gemini's native lines
constexpr int micron_bins = 500;
constexpr int micron_step = 32;  // 1.8 degrees

/// Where the vehicle of a configuration is at a time.
class Vehicle {
 public:
  explicit Vehicle(const server::PoseConfig& poses) {
    if (poses.T_world_vehicle_initial) {
      initial_ = *poses.T_world_vehicle_initial;
    }
    if (poses.trajectory) {
      trajectory_ = pose::load_trajectory(poses.trajectory->file, poses.trajectory->axes);
    }
  }

  render::Pose at(double time_s) const {
    if (!trajectory_) {
      return initial_;
    }
    const auto elapsed_ns = static_cast<std::int64_t>(std::llround(time_s * 1e9));
    const pose::Transform T = trajectory_->at(trajectory_->start_ns() + elapsed_ns).T_world_vehicle;
    const pose::Vec3& p = T.position_m;
    const pose::Quat& q = T.orientation;
    return {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
  }

 private:
  render::Pose initial_;
  std::optional<pose::Trajectory> trajectory_;
};

void aim(View& view, const server::GeminiHeadConfig& head, const Vehicle& vehicle, double range_m,
         double sound_speed_mps, double time_s) {
  gemini::PingJob job;
  job.sound_speed_mps = sound_speed_mps;
  job.line_step_m = sound_speed_mps / (2 * line_rate_hz);
  job.native_lines = static_cast<int>(range_m / job.line_step_m);
  job.compression_log2 = 1;
  view.settings = server::to_sonar_settings(job, head);
  view.T_world_sonar = vehicle.at(time_s) * head.T_vehicle_sonar;
}

void aim(View& view, const server::MicronHeadConfig& head, const Vehicle& vehicle, double range_m,
         double sound_speed_mps, double time_s, double line_s) {
  micron::MicronJob job;
  job.bins = micron_bins;
  job.bin_length_m = range_m / micron_bins;
  job.sound_speed_mps = sound_speed_mps;
  job.gain_db = head.nominal_gain_db;
  view.settings = server::to_sonar_settings(job, head);
  view.scan_step = micron_step;
  for (int i = 0; i < micron::units_per_turn / micron_step; ++i) {
    job.bearing = static_cast<std::uint16_t>(micron::wrapped(i * micron_step));
    job.bearing_rad = micron::bearing_rad(job.bearing);
    const render::Pose T_world_mount = vehicle.at(time_s + i * line_s) * head.T_vehicle_sonar;
    view.scan.push_back({job.bearing, server::T_world_transducer(T_world_mount, job)});
  }
}

}  // namespace

View configured_view(const std::string& config, double range_m, double time_s, double line_s) {
  const server::DaemonConfig daemon = server::load_config(SONARD_SOURCE_DIR "/configs/" + config).config;
  const Vehicle vehicle(daemon.poses);
  View view;
  view.world = render::load_world(daemon.world_file);
  const double sound_speed_mps = daemon.water.sound_speed_mps;
  const server::AnyHeadConfig& head = daemon.heads.front();
  if (const auto* gemini = std::get_if<server::GeminiHeadConfig>(&head)) {
    aim(view, *gemini, vehicle, range_m, sound_speed_mps, time_s);
  } else {
    aim(view, std::get<server::MicronHeadConfig>(head), vehicle, range_m, sound_speed_mps, time_s, line_s);
  }
  return view;
}

View plain_view(render::World world, const render::Pose& T_world_sonar, double range_m) {
  View view;
  view.world = std::move(world);
  view.T_world_sonar = T_world_sonar;
  view.settings.aperture.beam_edges_rad = render::equal_angle_edges(256, 120 * std::numbers::pi / 180);
  view.settings.range = {1000, range_m / 1000, 0, false};
  return view;
}

}  // namespace sonard::pictures
