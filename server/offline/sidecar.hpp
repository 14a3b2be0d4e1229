// SPDX-License-Identifier: Apache-2.0
// The JSON file of a frame, and other functions that sources of frames share.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>

#include "protocol/npy/npy_file.hpp"
#include "renderer/picture/sector_geometry.hpp"
#include "renderer/pose.hpp"
#include "server/heads/head_config.hpp"
#include "server/offline/body_truth.hpp"
#include "server/offline/options.hpp"
#include "server/offline/vehicle_trajectory.hpp"
#include "server/recording/events.hpp"

namespace sonard::server {

/// Members keep their order. docs/offline.md describes them.
using Json = nlohmann::ordered_json;

struct FrameFacts {
  int number = 0;
  std::string head;
  std::string type;           ///< of the head, as in the configuration
  std::int64_t stamp_ns = 0;  ///< on the clock of the trajectory
  std::int64_t unix_ns = 0;
};
/// The common beginning of all sidecars.
Json frame_json(const FrameFacts& facts);

struct Axis {
  std::string name;
  int size = 0;
};
/// @param name FrameSource::name()
Json samples_json(const std::string& name, bool sixteen_bit, const Axis& rows, const Axis& columns);
/// @param truth null: not requested
Json truth_json(const std::string& name, const BodyTruth* truth);
Json pose_json(const render::Pose& pose);

/// Adds the timing of pings to the settings of frames.
void add_times(Json& settings, const PingTimes& times, const OfflineOptions& options);

/// A ping for a log, with the pose that it was rendered from.
PingSent sent_ping(PingRecord record, std::int64_t unix_ns, const render::Pose& T_world_vehicle,
                   const HeadConfig& head);

/// One object, one member per line. The same values always give the same text.
std::string sidecar_text(const Json& object);

/// Samples for a picture: CV_8UC1, one row per row.
cv::Mat eight_bit_matrix(const npy::Table& samples);

/// Ids of bodies as a mask: CV_8UC1. Requires a table of 8 bits.
cv::Mat mask_matrix(const npy::Table& ids);

/// Files of OfflineOptions::clean_pictures, by FrameSource::name().
struct CleanNames {
  explicit CleanNames(const std::string& name)
      : grey(name + "_grey.png"),
        fan(name + "_fan.png"),
        grey_mask(name + "_grey_bodies.png"),
        fan_mask(name + "_fan_bodies.png") {}
  std::string grey, fan, grey_mask, fan_mask;
};
/// File names, and the map from pixel to bearing and range.
Json clean_json(const std::string& name, bool with_masks, const picture::SectorGeometry& fan);

// Files of a frame, by its name.
std::string npy_name(const std::string& name);
std::string bodies_name(const std::string& name);
std::string picture_name(const std::string& name);
std::string sidecar_name(const std::string& name);

}  // namespace sonard::server
