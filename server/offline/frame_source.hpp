// SPDX-License-Identifier: Apache-2.0
// What a head makes of a trajectory: frames, one after the other.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "protocol/glf/records.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/recording/events.hpp"

namespace sonard::server {

/// A head as it is numbered in its configuration.
struct HeadPlace {
  int stream = 0;      ///< among all heads
  int glf_number = 0;  ///< among those whose users know .glf logs
};

/// A picture without labels, and the file that holds it.
struct CleanPicture {
  std::string file;
  cv::Mat pixels;  ///< CV_8UC1
};

/// One ping of a fan, or one sweep of a scanning head, as the files that hold it.
struct Frame {
  std::string npy;                ///< samples
  std::string bodies_npy;         ///< ids of bodies; empty: not asked for
  std::string sidecar;            ///< JSON
  std::function<cv::Mat()> draw;  ///< the picture; of all frames one at a time
  /// Those of OfflineOptions::clean_pictures; of all frames one at a time.
  std::function<std::vector<CleanPicture>()> draw_clean;
};

/// Frames depend on nothing but what a source was made of, and on the frames before, which the renderer must
/// have rendered or passed in order: speckle evolves from ping to ping. One thread uses it.
class FrameSource {
 public:
  FrameSource() = default;
  virtual ~FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  virtual int count() const = 0;
  /// Stem of a frame's files: "ping_000012".
  virtual std::string name(int frame) const = 0;
  /// @throws render::RequestError, render::RendererError
  virtual Frame render(render::SonarRenderer& renderer, int frame) = 0;
  /// Leaves the renderer as render() does. @throws the same
  virtual void pass(render::SonarRenderer& renderer, int frame) = 0;

  /// The shortest time from ping to ping that the head can keep, and the one asked for.
  virtual double natural_period_s() const = 0;
  virtual double period_s() const = 0;

  /// What frames are made with, as a JSON object.
  virtual nlohmann::ordered_json settings_json() const = 0;

  /// Whether frames go into a .glf.
  virtual bool makes_glf() const { return false; }
  /// The record of a frame, of its samples as they stand in its file. @return nullopt where those are not of
  /// this frame
  virtual std::optional<glf::ImageRecord> record([[maybe_unused]] int frame,
                                                 [[maybe_unused]] std::string_view npy) const {
    return std::nullopt;
  }
  /// The pings of a frame for a log, of its samples as they stand in its file; transmit times are Unix times.
  /// Empty where those are not of this frame.
  virtual std::vector<PingSent> pings(int frame, std::string_view npy) const = 0;
  /// When it was sent.
  virtual std::int64_t unix_ns(int frame) const = 0;
};

}  // namespace sonard::server
