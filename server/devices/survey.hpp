// SPDX-License-Identifier: Apache-2.0
// Pings of a head along a trajectory, for rendering without serving.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "protocol/common/ping_job.hpp"
#include "protocol/common/ping_record.hpp"

namespace sonard::server {

/// Options of a sonar; each type takes those it supports and rejects the others.
struct SurveyOptions {
  std::optional<double> range_m;
  std::optional<double> gain_percent;
  std::optional<double> sound_speed_mps;
  std::optional<int> compression_log2;
  std::optional<int> bits;
  std::optional<std::string> frequency;  ///< "low" or "high", for a head with two frequencies
  std::optional<int> bins;
  std::optional<double> step_deg;
  std::vector<double> sector_deg;  ///< FROM and TO, or empty
};

/// A sequence of frames: pings of a multibeam head, or sweeps of a scanning head.
class Survey {
 public:
  Survey() = default;
  virtual ~Survey() = default;
  Survey(const Survey&) = delete;
  Survey& operator=(const Survey&) = delete;

  /// The shortest time between pings.
  virtual std::chrono::nanoseconds natural_period() const = 0;
  /// Plans this number of pings. @return the first ping of each frame that they fill, and the first ping
  /// after the last frame
  virtual std::vector<int> frames(int pings) = 0;
  /// One planned ping, without its time; its number is `ping`.
  virtual PingJob job(int ping) const = 0;

  /// Length of a bin at the sound speed that the client has set, in metres.
  virtual double client_bin_m() const = 0;
  /// Bearings of the beams of a multibeam head, positive to starboard; empty for a scanning head.
  virtual std::vector<double> bearings_rad() const { return {}; }

  struct Sector {
    double left_rad = 0.0;   ///< positive to starboard
    double width_rad = 0.0;  ///< clockwise; 2 pi: a whole turn
    double step_rad = 0.0;   ///< between pings
  };
  /// The sector of a scanning head.
  virtual Sector sector() const { return {}; }

  /// Settings of the frames as a JSON object, without the period.
  virtual nlohmann::ordered_json settings_json() const = 0;
  /// The record of a ping, for a log. Its transmit time is not set, and its wire message only if a type
  /// overrides this function.
  /// @param samples 8 bits each, or the high bytes of 16 bits
  virtual PingRecord record(int ping, std::vector<std::uint8_t> samples) const;

  /// For jobs with directions: the ranges in metres and the signals that a client gets for these echoes.
  virtual DirectionRanges measured(const DirectionRanges& echoes) const { return echoes; }
  /// The record of such a ping, as record().
  /// @param sent by measured()
  virtual PingRecord record_of_measured(int ping, const DirectionRanges& sent, std::int64_t unix_ns) const;
};

}  // namespace sonard::server
