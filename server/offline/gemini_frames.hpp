// The pings of a Gemini along a voyage.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "protocol/gemini/ping_plan.hpp"
#include "renderer/picture/fan_image.hpp"
#include "server/config/config.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/frame_source.hpp"
#include "server/offline/options.hpp"
#include "server/offline/voyage.hpp"

namespace sonard::server {

/// A head as it is numbered in its configuration.
struct HeadPlace {
  int stream = 0;         ///< among all heads
  int gemini_number = 0;  ///< among the Geminis
};

/// The settings of the user go the way of a client's: through a ping configuration, the head's plan of it and
/// to_sonar_settings(). A frame is a ping, and has its number.
class GeminiFrames final : public FrameSource {
 public:
  /// All arguments but the options outlive this. @param truth null: not asked for
  GeminiFrames(const GeminiHeadConfig& head, const HeadPlace& place, const Voyage& voyage,
               const OfflineOptions& options, BodyTruth* truth);

  int count() const override { return count_; }
  std::string name(int frame) const override;
  Frame render(render::SonarRenderer& renderer, int frame) override;
  void pass(render::SonarRenderer& renderer, int frame) override;
  std::string settings_json() const override;
  bool makes_glf() const override { return true; }
  std::optional<glf::ImageRecord> record(int frame, std::string_view npy) const override;
  std::int64_t unix_ns(int frame) const override { return voyage_.unix_ns(times_.at(frame)); }

  /// What the renderer is asked for.
  render::PingRequest request(int frame) const;

 private:
  render::Pose T_world_sonar(std::int64_t time_ns) const;
  std::string sidecar(int frame, const render::PingRequest& request) const;
  std::string caption(int frame) const;

  const GeminiHeadConfig& head_;
  HeadPlace place_;
  const Voyage& voyage_;
  gemini::PingSettings asked_;
  gemini::PingPlan plan_;
  PingTimes times_;
  int count_;
  BodyTruth* truth_;
  picture::FanImage fan_;
};

}  // namespace sonard::server
