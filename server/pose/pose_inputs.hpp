// SPDX-License-Identifier: Apache-2.0
// All pose sources of a configuration, with statistics of each.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "server/pose/pose_config.hpp"
#include "server/pose/pose_source.hpp"
#include "server/pose/pose_statistics.hpp"
#include "server/pose/publisher_id.hpp"

namespace sonard::server {

/// Belongs to the I/O thread. The owner of the io_context constructs and destroys it while the context does
/// not run. It logs a line for each source every `report_period` and when it is stopped; a source that stays
/// silent is logged once.
class PoseInputs {
 public:
  /// Every pose of every source goes to `sink`. `hold` may be empty: publishers then never wait.
  /// @throws Error
  PoseInputs(boost::asio::io_context& io, const PoseConfig& config, const Clock& clock, PoseSink sink,
             PoseHold hold = {}, std::chrono::milliseconds report_period = std::chrono::seconds{10});

  /// @throws Error
  void start();
  void stop();

  std::size_t size() const { return sources_.size(); }
  const PoseSource& source(std::size_t index) const { return *sources_[index]; }
  /// PoseConfig::clock
  PingClock ping_clock() const { return ping_clock_; }
  const PoseStatistics& statistics(std::size_t index) const { return *statistics_[index]; }
  /// Publishers that sent poses to an input within the last two seconds, except those that a later publisher
  /// replaced. Empty if the source does not distinguish publishers.
  std::vector<PublisherId> publishers(std::size_t index, TimePoint now) const;

 private:
  /// Times of a publisher's first and newest pose.
  struct Times {
    TimePoint first{}, last{};
  };
  using Publishers = std::map<PublisherId, Times>;

  void note_publisher(std::size_t index, TimePoint now);
  void report_every_period();
  void report();

  const Clock& clock_;
  PingClock ping_clock_;
  std::chrono::milliseconds report_period_;
  std::vector<std::unique_ptr<PoseStatistics>> statistics_;  // by source
  std::vector<std::unique_ptr<PoseSource>> sources_;
  std::vector<Publishers> publishers_;  // by source
  std::vector<bool> told_silent_;       // by source
  bool running_ = false;
  boost::asio::steady_timer report_timer_;
};

}  // namespace sonard::server
