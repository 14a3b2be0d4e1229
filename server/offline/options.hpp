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
  Shard shard;
  bool overwrite = false;
  bool truth = false;   ///< also which body echoes most in each bin
  int radius_px = 900;  ///< of pictures
  struct BodyWay {
    std::string body;  ///< of the world
    std::filesystem::path trajectory;
  };
  std::vector<BodyWay> bodies;  ///< bodies that move along files of their own, in the axes of `trajectory`
  int picture_every = 1;        ///< frames from picture to picture, >= 1; 0: none is drawn
  SurveyOptions survey;         ///< what the sonar is asked for

  bool draws(int frame) const { return picture_every > 0 && frame % picture_every == 0; }
};

}  // namespace sonard::server
