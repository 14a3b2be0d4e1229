// SPDX-License-Identifier: Apache-2.0
// The pings that a head would make along a trajectory, for rendering without serving.
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

/// Options of a sonar; each kind takes those it knows and refuses the rest.
struct SurveyOptions {
  std::optional<double> range_m;
  std::optional<double> gain_percent;
  std::optional<double> sound_speed_mps;
  std::optional<int> compression_log2;
  std::optional<int> bits;
  std::optional<std::string> frequency;  ///< "low" or "high", of a head with two
  std::optional<int> bins;
  std::optional<double> step_deg;
  std::vector<double> sector_deg;  ///< FROM and TO, or nothing
};

/// Frame by frame: a ping of a multibeam head, or a sweep of a scanning one.
class Survey {
 public:
  Survey() = default;
  virtual ~Survey() = default;
  Survey(const Survey&) = delete;
  Survey& operator=(const Survey&) = delete;

  /// The shortest time from ping to ping.
  virtual std::chrono::nanoseconds natural_period() const = 0;
  /// Plans so many pings. @return first pings of the frames that they fill, and after the last frame the
  /// first ping that is in none
  virtual std::vector<int> frames(int pings) = 0;
  /// One of these pings, without its time; its number is `ping`.
  virtual PingJob job(int ping) const = 0;

  /// Length of a bin as a client has it, which counts ranges in the speed of sound that it has set.
  virtual double client_bin_m() const = 0;
  /// Bearings of the beams of a multibeam head, positive to starboard; empty for a scanning one.
  virtual std::vector<double> bearings_rad() const { return {}; }

  struct Sector {
    double left_rad = 0.0;   ///< positive to starboard
    double width_rad = 0.0;  ///< clockwise; a whole turn: all round
    double step_rad = 0.0;   ///< from ping to ping
  };
  /// The sector of a scanning head.
  virtual Sector sector() const { return {}; }

  /// Settings of the frames as a JSON object, without the period.
  virtual nlohmann::ordered_json settings_json() const = 0;
  /// A ping as a log keeps it, whose samples these are: 8 bits each, or the high ones of 16. Its transmit
  /// time is left out, and the message on the wire where a kind does not override this.
  virtual PingRecord record(int ping, std::vector<std::uint8_t> samples) const;
};

}  // namespace sonard::server
