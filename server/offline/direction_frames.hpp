// SPDX-License-Identifier: Apache-2.0
// The pings along a trajectory of a head that measures the range in directions.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "renderer/picture/direction_picture.hpp"
#include "server/devices/survey.hpp"
#include "server/heads/head_config.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/frame_source.hpp"
#include "server/offline/options.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// A frame is a ping, and has its number. Its samples are a table of floats: the ranges in metres as the head
/// sends them, row by row from the lowest, and then its signals. Two more files have the points, x forward, y
/// to starboard, z down: NAME_points.npy, with a signal for each, and NAME.ply.
class DirectionFrames final : public FrameSource {
 public:
  /// All references, and `truth`, must outlive this object. @param truth null: no masks of bodies
  DirectionFrames(const HeadConfig& head, const HeadPlace& place, std::unique_ptr<Survey> survey,
                  const VehicleTrajectory& trajectory, const OfflineOptions& options, BodyTruth* truth);

  int count() const override { return count_; }
  std::string name(int frame) const override;
  Frame render(render::SonarRenderer& renderer, int frame) override;
  /// Frames do not depend on each other.
  void pass(render::SonarRenderer&, int) override {}
  double natural_period_s() const override {
    return std::chrono::duration<double>(survey_->natural_period()).count();
  }
  double period_s() const override { return times_.period_ns / 1e9; }
  nlohmann::ordered_json settings_json() const override;
  std::vector<PingSent> pings(int frame, std::string_view npy) const override;
  std::int64_t unix_ns(int frame) const override { return trajectory_.unix_ns(times_.at(frame)); }

 private:
  render::PingRequest request(int frame) const;
  std::vector<std::uint16_t> bodies_of(const DirectionRanges& sent, const render::PingRequest& ping);
  picture::DirectionImage image_of(const DirectionRanges& sent) const;
  std::string sidecar(int frame, const render::PingRequest& request) const;

  const HeadConfig& head_;
  const OfflineOptions options_;
  HeadPlace place_;
  const VehicleTrajectory& trajectory_;
  std::unique_ptr<Survey> survey_;
  BodyTruth* truth_;
  PingTimes times_;
  int count_;
  PingJob job_;  ///< the same for all pings, except its number
};

}  // namespace sonard::server
