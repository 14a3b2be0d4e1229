// SPDX-License-Identifier: Apache-2.0
// Joins the images that a Sonar 3D-15 sends to shots.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_job.hpp"
#include "protocol/sonar3d15/codec.hpp"

namespace sonard::client {

struct ReceivedShot {
  sonar3d15::RangeImage range;
  sonar3d15::BitmapImageGreyscale8 signal;
  TimePoint received{};  ///< when its signal image came
};

struct ShotStatistics {
  std::uint64_t packets = 0;
  std::uint64_t bad_packets = 0;   ///< not readable
  std::uint64_t shots_missed = 0;  ///< by the numbers of the shots
  std::uint64_t unpaired = 0;      ///< signal images without a range image before them
};

class Shots {
 public:
  void receive(TimePoint at, std::span<const std::uint8_t> datagram);
  std::vector<ReceivedShot> take();
  const ShotStatistics& statistics() const { return statistics_; }

 private:
  void pair(TimePoint at, const sonar3d15::BitmapImageGreyscale8& signal);

  std::optional<sonar3d15::RangeImage> range_;  ///< without its signal image
  std::optional<std::uint32_t> newest_;         ///< number of the newest shot
  std::vector<ReceivedShot> shots_;
  ShotStatistics statistics_;
};

}  // namespace sonard::client
