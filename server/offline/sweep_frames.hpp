// SPDX-License-Identifier: Apache-2.0
// The sweeps of a scanning head along a trajectory.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/picture/sweep_image.hpp"
#include "server/devices/survey.hpp"
#include "server/heads/head_config.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/frame_source.hpp"
#include "server/offline/options.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// A frame is a turn, or a sweep of the sector from one limit to the other. Only whole frames count. Each
/// line is a ping with its own number and pose.
class SweepFrames final : public FrameSource {
 public:
  /// All references and `truth` must outlive this object. @param truth null: not requested
  SweepFrames(const HeadConfig& head, int head_index, std::unique_ptr<Survey> survey,
              const VehicleTrajectory& trajectory, const OfflineOptions& options, BodyTruth* truth);

  /// 0 if the trajectory ends before the first sweep does.
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

  /// The request to the renderer, by the line's number since the start.
  render::PingRequest request(int line) const;
  /// First line of a frame; its lines end before the first of the next frame.
  int first_line(int frame) const { return first_lines_[static_cast<std::size_t>(frame)]; }

 private:
  std::vector<CleanPicture> clean_pictures(int frame, const npy::Table& samples,
                                           const npy::Table* bodies) const;
  std::string sidecar(int frame) const;

  const HeadConfig& head_;
  const OfflineOptions options_;
  int head_index_;
  const VehicleTrajectory& trajectory_;
  std::unique_ptr<Survey> survey_;
  PingTimes times_;
  std::vector<int> first_lines_;  ///< of every frame, and the end of the last
  int bins_;
  BodyTruth* truth_;
  picture::SweepImage picture_;
  std::optional<picture::SweepImage> clean_picture_;  ///< without labels; only if requested
};

}  // namespace sonard::server
