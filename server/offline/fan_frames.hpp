// SPDX-License-Identifier: Apache-2.0
// The pings of a multibeam head along a trajectory.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/picture/fan_image.hpp"
#include "server/devices/survey.hpp"
#include "server/heads/head_config.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/frame_source.hpp"
#include "server/offline/options.hpp"
#include "server/offline/vehicle_trajectory.hpp"

namespace sonard::server {

/// A frame is a ping, and has its number.
class FanFrames final : public FrameSource {
 public:
  /// All references and `truth` must outlive this object. @param truth null: not requested
  FanFrames(const HeadConfig& head, const HeadPlace& place, std::unique_ptr<Survey> survey,
            const VehicleTrajectory& trajectory, const OfflineOptions& options, BodyTruth* truth);

  int count() const override { return count_; }
  std::string name(int frame) const override;
  Frame render(render::SonarRenderer& renderer, int frame) override;
  void pass(render::SonarRenderer& renderer, int frame) override;
  double natural_period_s() const override {
    return std::chrono::duration<double>(survey_->natural_period()).count();
  }
  double period_s() const override { return times_.period_ns / 1e9; }
  nlohmann::ordered_json settings_json() const override;
  bool makes_glf() const override;
  std::optional<glf::ImageRecord> record(int frame, std::string_view npy) const override;
  std::vector<PingSent> pings(int frame, std::string_view npy) const override;
  std::int64_t unix_ns(int frame) const override { return trajectory_.unix_ns(times_.at(frame)); }

  /// The request to the renderer.
  render::PingRequest request(int frame) const;

 private:
  render::Pose T_world_sonar(std::int64_t time_ns) const;
  std::optional<PingRecord> ping_record(int frame, std::string_view npy) const;
  std::vector<CleanPicture> clean_pictures(int frame, const npy::Table& samples, const cv::Mat& ids) const;
  std::string sidecar(int frame, const render::PingRequest& request) const;
  std::string caption(int frame) const;

  const HeadConfig& head_;
  const OfflineOptions options_;
  HeadPlace place_;
  const VehicleTrajectory& trajectory_;
  std::unique_ptr<Survey> survey_;
  PingTimes times_;
  int count_;
  PingJob job_;  ///< the same for all pings, except its number
  std::vector<double> bearings_rad_;
  BodyTruth* truth_;
  picture::FanImage fan_;
  std::optional<picture::FanImage> clean_fan_;  ///< without labels; only if requested
};

}  // namespace sonard::server
