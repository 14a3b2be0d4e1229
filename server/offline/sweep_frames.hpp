// SPDX-License-Identifier: Apache-2.0
// The sweeps of a scanning head along a trajectory.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/picture/sweep_image.hpp"
#include "server/config/config.hpp"
#include "server/devices/survey.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/frame_source.hpp"
#include "server/offline/options.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// A frame is a turn, or a sweep of the sector from one limit to the other, and of whole ones only; each of
/// its lines is a ping with a number and a pose of its own.
class SweepFrames final : public FrameSource {
 public:
  /// All arguments but the survey and the options outlive this. @param truth null: not asked for
  SweepFrames(const HeadConfig& head, int stream, std::unique_ptr<Survey> survey,
              const VehicleTrajectory& trajectory, const OfflineOptions& options, BodyTruth* truth);

  /// 0 where the trajectory is over before the first sweep is.
  int count() const override { return static_cast<int>(first_lines_.size()) - 1; }
  std::string name(int frame) const override;
  Frame render(render::SonarRenderer& renderer, int frame) override;
  void pass(render::SonarRenderer& renderer, int frame) override;
  double natural_period_s() const override {
    return std::chrono::duration<double>(survey_->natural_period()).count();
  }
  double period_s() const override { return times_.period_ns / 1e9; }
  nlohmann::ordered_json settings_json() const override;
  std::vector<PingSent> pings(int frame, std::string_view npy) const override;
  std::int64_t unix_ns(int frame) const override { return trajectory_.unix_ns(times_.at(first_line(frame))); }

  /// What the renderer is asked for, by the number of the line since the beginning.
  render::PingRequest request(int line) const;
  /// Lines of a frame: from its first to the first of the next.
  int first_line(int frame) const { return first_lines_[static_cast<std::size_t>(frame)]; }

 private:
  std::vector<CleanPicture> clean_pictures(int frame, const npy::Table& samples,
                                           const npy::Table* bodies) const;
  std::string sidecar(int frame) const;

  const HeadConfig& head_;
  const OfflineOptions options_;
  int stream_;
  const VehicleTrajectory& trajectory_;
  std::unique_ptr<Survey> survey_;
  PingTimes times_;
  std::vector<int> first_lines_;  ///< of every frame, and the end of the last
  int bins_;
  BodyTruth* truth_;
  picture::SweepImage picture_;
  std::optional<picture::SweepImage> clean_picture_;  ///< without labels, where those are asked for
};

}  // namespace sonard::server
