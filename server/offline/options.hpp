// SPDX-License-Identifier: Apache-2.0
// What a user asks of `sonard render`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "protocol/pose/pose_codec.hpp"
#include "server/devices/survey.hpp"

namespace sonard::server {

/// Which frames a process renders: those whose number leaves the remainder index % count.
struct Shard {
  int index = 0;  ///< 0..count: the count stands for 0, so that counting from 1 works as from 0
  int count = 1;  ///< >= 1

  bool has(int frame) const { return frame % count == index % count; }
  bool operator==(const Shard&) const = default;
};

/// "1/3". @return nullopt for anything else
std::optional<Shard> parse_shard(const std::string& text);

struct OfflineOptions {
  std::filesystem::path trajectory;
  pose::Axes axes = pose::Axes::enu_flu;
  std::filesystem::path out;
  std::string head;                   ///< empty: the first of the configuration
  std::optional<double> rate_hz;      ///< pings a second, > 0; nullopt: as fast as the head can
  std::optional<std::uint64_t> seed;  ///< nullopt: the one of the head
  std::optional<std::uint64_t>
      element_seed;  ///< of errors of the array's elements; nullopt: as the head has it
  /// Whether the sonar is at rest in each ping; nullopt: where the trajectory is none that a vehicle can
  /// follow.
  std::optional<bool> still;
  Shard shard;
  bool overwrite = false;
  bool truth = false;   ///< also which body echoes most in each bin
  int radius_px = 900;  ///< of pictures
  struct BodyWay {
    std::string body;  ///< of the world
    std::filesystem::path trajectory;
  };
  std::vector<BodyWay> bodies;  ///< bodies that move along files of their own, in the axes of `trajectory`
  bool clean_pictures = false;  ///< also grey pictures without labels, and masks of them with `truth`
  bool mcap = false;            ///< also a log with topics for Foxglove
  int picture_every = 1;        ///< frames from picture to picture, >= 1; 0: none is drawn
  SurveyOptions survey;         ///< what the sonar is asked for

  /// Whether each pose of the trajectory is a frame of its own.
  bool frame_for_each_pose() const { return still.value_or(false) && !rate_hz; }
  bool draws(int frame) const { return picture_every > 0 && frame % picture_every == 0; }
};

}  // namespace sonard::server
