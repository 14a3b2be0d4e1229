// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/view.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "protocol/common/ping_job.hpp"
#include "protocol/micron/units.hpp"
#include "protocol/pose/trajectory.hpp"
#include "server/config/loader.hpp"
#include "server/devices/device_type.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/devices/micron/config.hpp"
#include "server/devices/micron/type.hpp"
#include "server/devices/types/types.hpp"
#include "server/pose/trajectory/input.hpp"

namespace sonard::pictures {
namespace {

constexpr double line_rate_hz = 90'422;  // of a Gemini's range bins
constexpr int micron_bins = 500;
constexpr int micron_step = 32;  // 1.8 degrees

/// The pose of a configuration's vehicle by time.
class Vehicle {
 public:
  explicit Vehicle(const server::PoseConfig& poses) {
    if (poses.T_world_vehicle_initial) {
      initial_ = *poses.T_world_vehicle_initial;
    }
    if (const auto* trajectory = server::settings_of<server::TrajectoryInput>(poses)) {
      trajectory_ = pose::load_trajectory(trajectory->file, trajectory->axes);
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

void aim_gemini(View& view, const server::HeadConfig& head, const Vehicle& vehicle, double range_m,
                double sound_speed_mps, double time_s) {
  PingJob job;
  job.sound_speed_mps = sound_speed_mps;
  job.native_bin_m = sound_speed_mps / (2 * line_rate_hz);
  job.native_bins = static_cast<int>(range_m / job.native_bin_m);
  job.compression_log2 = 1;
  view.settings = server::gemini_type().sonar_settings(job, head);
  view.T_world_sonar = vehicle.at(time_s) * head.T_vehicle_sonar;
}

/// Settings for any other multibeam head, with its usual ping.
void aim_fan(View& view, const server::HeadConfig& head, const Vehicle& vehicle, double range_m,
             double time_s) {
  PingJob job = server::type_of(head).usual_job(head);
  job.native_bins = static_cast<int>(range_m / job.native_bin_m);
  view.settings = server::type_of(head).sonar_settings(job, head);
  view.T_world_sonar = vehicle.at(time_s) * head.T_vehicle_sonar;
}

void aim_micron(View& view, const server::HeadConfig& head, const Vehicle& vehicle, double range_m,
                double sound_speed_mps, double time_s, double line_s) {
  PingJob job;
  job.native_bins = micron_bins;
  job.native_bin_m = range_m / micron_bins;
  job.sound_speed_mps = sound_speed_mps;
  job.gain_db = server::device_settings<server::MicronConfig>(head).nominal_gain_db;
  view.settings = server::micron_type().sonar_settings(job, head);
  view.scan_step = micron_step;
  for (int i = 0; i < micron::units_per_turn / micron_step; ++i) {
    const int bearing = micron::wrapped(i * micron_step);
    const render::Pose T_world_mount = vehicle.at(time_s + i * line_s) * head.T_vehicle_sonar;
    view.scan.push_back({bearing, server::T_world_transducer(T_world_mount, micron::bearing_rad(bearing))});
  }
}

server::DaemonConfig load(const std::string& config) {
  return server::load_config(SONARD_SOURCE_DIR "/configs/" + config, server::head_types()).config;
}

}  // namespace

std::vector<render::Pose> poses_along(const std::string& config, const std::string& trajectory,
                                      const std::vector<double>& times_s) {
  server::DaemonConfig daemon = load(config);
  daemon.poses.inputs = {
      server::pose_input(server::TrajectoryInput{.file = SONARD_SOURCE_DIR "/configs/" + trajectory})};
  const Vehicle vehicle(daemon.poses);
  std::vector<render::Pose> T_world_sonar;
  for (const double time_s : times_s) {
    T_world_sonar.push_back(vehicle.at(time_s) * daemon.heads.front().T_vehicle_sonar);
  }
  return T_world_sonar;
}

View configured_view(const std::string& config, double range_m, double time_s, double line_s) {
  const server::DaemonConfig daemon = load(config);
  const Vehicle vehicle(daemon.poses);
  View view;
  view.world = render::load_world(daemon.world.file);
  const double sound_speed_mps = daemon.water.sound_speed_mps;
  const server::HeadConfig& head = daemon.heads.front();
  if (head.type == &server::gemini_type()) {
    aim_gemini(view, head, vehicle, range_m, sound_speed_mps, time_s);
  } else if (head.type == &server::micron_type()) {
    aim_micron(view, head, vehicle, range_m, sound_speed_mps, time_s, line_s);
  } else if (!server::type_of(head).scanning()) {
    aim_fan(view, head, vehicle, range_m, time_s);
  } else {
    throw std::invalid_argument(config + ": of scanning heads only a Micron has a view");
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
