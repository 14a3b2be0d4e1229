// SPDX-License-Identifier: Apache-2.0
// Options of `sonard render`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "protocol/pose/pose_codec.hpp"
#include "server/devices/survey.hpp"

namespace sonard::server {

/// Frames that a process renders: those with number % count == index % count.
struct Shard {
  int index = 0;  ///< 0..count; count means 0, so that shards can be counted from 0 or from 1
  int count = 1;  ///< >= 1

  bool has(int frame) const { return frame % count == index % count; }
  bool operator==(const Shard&) const = default;
};

/// Parses "1/3". @return nullopt for any other text
std::optional<Shard> parse_shard(const std::string& text);

struct OfflineOptions {
  std::filesystem::path trajectory;
  pose::Axes axes = pose::Axes::enu_flu;
  std::filesystem::path out;
  std::string head;                           ///< empty: the first head of the configuration
  std::optional<double> rate_hz;              ///< pings per second, > 0; nullopt: as fast as the head can
  std::optional<std::uint64_t> seed;          ///< nullopt: from the head
  std::optional<std::uint64_t> element_seed;  ///< for errors of the array's elements; nullopt: from the head
  /// True: the sonar is at rest in each ping; nullopt: only if no vehicle can follow the trajectory.
  std::optional<bool> still;
  Shard shard;
  bool overwrite = false;
  bool truth = false;   ///< also writes the loudest body of each bin
  int radius_px = 900;  ///< of pictures
  struct BodyWay {
    std::string body;  ///< name in the world
    std::filesystem::path trajectory;
  };
  std::vector<BodyWay> bodies;  ///< bodies that move along their own files, in the axes of `trajectory`
  bool clean_pictures = false;  ///< also writes grey pictures without labels and, with `truth`, masks of them
  bool mcap = false;            ///< also writes a log with topics for Foxglove
  int picture_every = 1;        ///< one picture per so many frames, >= 1; 0: no pictures
  SurveyOptions survey;         ///< settings of the sonar

  /// True if each pose of the trajectory is a frame of its own.
  bool frame_for_each_pose() const { return still.value_or(false) && !rate_hz; }
  bool draws(int frame) const { return picture_every > 0 && frame % picture_every == 0; }
};

}  // namespace sonard::server
