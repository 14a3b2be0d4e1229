// SPDX-License-Identifier: Apache-2.0
// The JSON beside a frame, and what else the sources of frames share.
#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core/mat.hpp>

#include "server/npy/npy_file.hpp"
#include "server/offline/body_truth.hpp"

namespace sonard::server {

/// One object, a member to a line. docs/offline.md describes it.
class SidecarText {
 public:
  struct FrameFacts {
    int number = 0;
    std::string head;
    std::string type;           ///< of the head, as in the configuration
    std::int64_t stamp_ns = 0;  ///< of the trajectory
    std::int64_t unix_ns = 0;
  };
  struct Axis {
    std::string name;
    int size = 0;
  };

  void add(const std::string& key, const std::string& json);
  void add_frame(const FrameFacts& facts);
  /// @param name FrameSource::name()
  void add_samples(const std::string& name, bool sixteen_bit, const Axis& rows, const Axis& columns);
  /// @param truth null: it was not asked for
  void add_truth(const std::string& name, const BodyTruth* truth);
  std::string finish() const { return text_ + "\n}\n"; }

 private:
  std::string text_;
};

/// Samples for a picture: CV_8UC1, a row for each row.
cv::Mat eight_bit_matrix(const NpyTable& samples);

// Files of a frame, by its name.
std::string npy_name(const std::string& name);
std::string bodies_name(const std::string& name);
std::string picture_name(const std::string& name);
std::string sidecar_name(const std::string& name);

}  // namespace sonard::server
