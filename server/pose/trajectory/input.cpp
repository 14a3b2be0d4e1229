// SPDX-License-Identifier: Apache-2.0
#include "server/pose/trajectory/input.hpp"

#include <utility>

#include <fmt/format.h>

#include "common/text/counted.hpp"
#include "protocol/pose/trajectory.hpp"
#include "server/error/error.hpp"
#include "server/pose/to_render.hpp"
#include "server/pose/trajectory/source.hpp"

namespace sonard::server {
namespace {

constexpr const char* file_key = "poses.trajectory.file";

class PlayedTrajectory final : public PoseInputWith<TrajectoryInput> {
 public:
  explicit PlayedTrajectory(TrajectoryInput values)
      : PoseInputWith(trajectory_pose_source_type(), std::move(values)) {}

  std::string summary() const override {
    const pose::Trajectory trajectory = load();
    return fmt::format("trajectory {} ({}, {:.1f} s)", settings.file.string(),
                       counted(trajectory.points().size(), "pose"),
                       1e-9 * static_cast<double>(trajectory.end_ns() - trajectory.start_ns()));
  }

  std::optional<FirstPose> first_pose() const override {
    try {
      return FirstPose{file_key, to_render(load().points().front().T_world_vehicle)};
    } catch (const Error&) {  // summary() throws it, too
      return std::nullopt;
    }
  }

  std::unique_ptr<PoseSource> open(boost::asio::io_context& io, const Clock& clock, PoseSink sink,
                                   PoseHold /*hold*/) const override {
    return std::make_unique<TrajectoryPoseSource>(io, load(), settings, clock, std::move(sink));
  }

 private:
  pose::Trajectory load() const {
    try {
      return pose::load_trajectory(settings.file, settings.axes);
    } catch (const pose::TrajectoryError& error) {
      throw Error(ErrorKind::configuration, error.what(), file_key);
    }
  }
};

std::shared_ptr<const PoseInput> read_trajectory(YamlSection& section, const std::filesystem::path& folder) {
  TrajectoryInput trajectory;
  section.require("file", "a trajectory file, CSV or TUM");
  section.path("file", trajectory.file, folder, "trajectory file, CSV or TUM ([poses.md](poses.md))");
  section.boolean("loop", trajectory.loop,
                  "true: playback starts again at the end; false: the last pose remains");
  section.number("speed", trajectory.speed, Range::above(0.0, 1000.0),
                 "playback speed; 2 is twice as fast as recorded");
  section.choice("axes", trajectory.axes,
                 {{"enu_flu", pose::Axes::enu_flu}, {"ned_frd", pose::Axes::ned_frd}},
                 "convention for the axes of world and vehicle in the file");
  return pose_input(std::move(trajectory));
}

}  // namespace

std::shared_ptr<const PoseInput> pose_input(TrajectoryInput settings) {
  return std::make_shared<PlayedTrajectory>(std::move(settings));
}

const PoseSourceType& trajectory_pose_source_type() {
  static const PoseSourceType type{.key = "trajectory",
                                   .meaning = "trajectory file, played from the start of the daemon",
                                   .is_live = false,
                                   .read = &read_trajectory};
  return type;
}

}  // namespace sonard::server
