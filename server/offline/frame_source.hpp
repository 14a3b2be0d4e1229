// SPDX-License-Identifier: Apache-2.0
// Frames of a head along a trajectory, one after the other.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "protocol/glf/records.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/recording/events.hpp"

namespace sonard::server {

/// Numbers of a head in its configuration.
struct HeadPlace {
  int head = 0;        ///< among all heads
  int glf_number = 0;  ///< among heads with .glf logs
};

/// A picture without labels, and its file name.
struct CleanPicture {
  std::string file;
  cv::Mat pixels;  ///< CV_8UC1
};

/// Place and echoes of a frame, to find the cause of a black picture; of a sweep, its first line's place and
/// its best line's echo.
struct FrameView {
  std::int64_t time_ns = 0;  ///< of the trajectory
  double range_m = 0.0;
  bool sees_surface = false;
  double echo_over_floor = 0.0;  ///< as in render::PingStatistics

  void add(const render::PingStatistics& ping) {
    sees_surface = sees_surface || ping.sees_surface;
    echo_over_floor = std::max(echo_over_floor, ping.echo_over_floor);
  }
};

/// Contents of the files of one ping of a fan, or one sweep of a scanning head.
struct Frame {
  std::string npy;                                        ///< samples
  std::string bodies_npy;                                 ///< ids of bodies; empty: not requested
  std::vector<std::pair<std::string, std::string>> more;  ///< names and contents of further files
  std::string sidecar;                                    ///< JSON
  std::function<cv::Mat()> draw;                          ///< draws the picture; for one frame at a time
  /// Draws OfflineOptions::clean_pictures; for one frame at a time.
  std::function<std::vector<CleanPicture>()> draw_clean;
  FrameView view;
};

/// Frames depend only on the arguments of a source and on the frames before, which the renderer must have
/// rendered or passed in order, because speckle evolves from ping to ping. For one thread.
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
  /// Leaves the renderer in the same state as render(). @throws as render()
  virtual void pass(render::SonarRenderer& renderer, int frame) = 0;

  /// The shortest ping period that the head can keep, and the requested period.
  virtual double natural_period_s() const = 0;
  virtual double period_s() const = 0;

  /// Settings of the frames, as a JSON object.
  virtual nlohmann::ordered_json settings_json() const = 0;

  /// True if frames go into a .glf.
  virtual bool makes_glf() const { return false; }
  /// The record of a frame, with the samples of its file. @return nullopt if the samples are not of this
  /// frame
  virtual std::optional<glf::ImageRecord> record([[maybe_unused]] int frame,
                                                 [[maybe_unused]] std::string_view npy) const {
    return std::nullopt;
  }
  /// The pings of a frame for a log, with the samples of its file; transmit times are Unix times. Empty if
  /// the samples are not of this frame.
  virtual std::vector<PingSent> pings(int frame, std::string_view npy) const = 0;
  /// Transmit time of a frame.
  virtual std::int64_t unix_ns(int frame) const = 0;
};

}  // namespace sonard::server
