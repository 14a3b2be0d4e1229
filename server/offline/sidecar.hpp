// SPDX-License-Identifier: Apache-2.0
// The JSON beside a frame, and what else the sources of frames share.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>

#include "protocol/npy/npy_file.hpp"
#include "renderer/pose.hpp"
#include "server/offline/body_truth.hpp"

namespace sonard::server {

/// Members keep their order. docs/offline.md describes them.
using Json = nlohmann::ordered_json;

struct FrameFacts {
  int number = 0;
  std::string head;
  std::string type;           ///< of the head, as in the configuration
  std::int64_t stamp_ns = 0;  ///< of the trajectory
  std::int64_t unix_ns = 0;
};
/// What every sidecar begins with.
Json frame_json(const FrameFacts& facts);

struct Axis {
  std::string name;
  int size = 0;
};
/// @param name FrameSource::name()
Json samples_json(const std::string& name, bool sixteen_bit, const Axis& rows, const Axis& columns);
/// @param truth null: it was not asked for
Json truth_json(const std::string& name, const BodyTruth* truth);
Json pose_json(const render::Pose& pose);

/// One object, a member to a line. The same values give the same text everywhere.
std::string sidecar_text(const Json& object);

/// Samples for a picture: CV_8UC1, a row for each row.
cv::Mat eight_bit_matrix(const npy::Table& samples);

// Files of a frame, by its name.
std::string npy_name(const std::string& name);
std::string bodies_name(const std::string& name);
std::string picture_name(const std::string& name);
std::string sidecar_name(const std::string& name);

}  // namespace sonard::server
