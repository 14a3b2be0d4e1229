// SPDX-License-Identifier: Apache-2.0
// All pose sources of a configuration, and how well each delivers.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "server/pose/pose_source.hpp"
#include "server/pose/pose_statistics.hpp"

namespace sonard::server {

/// Belongs to the I/O thread, as its sources do; made and destroyed by the owner of the io_context while it
/// does not run. Every `report_period`, and when it is stopped, it logs a line for each source; a source
/// that stays silent is logged once.
class PoseInputs {
 public:
  /// Every pose of every source goes to `sink`. `hold` may be empty: no publisher has to wait.
  /// @throws what make_pose_sources() throws
  PoseInputs(boost::asio::io_context& io, const PoseConfig& config, const Clock& clock, PoseSink sink,
             PoseHold hold = {}, std::chrono::milliseconds report_period = std::chrono::seconds{10});

  /// @throws PoseSourceError
  void start();
  void stop();

  std::size_t size() const { return sources_.size(); }
  const PoseSource& source(std::size_t index) const { return *sources_[index]; }
  /// PoseConfig::clock
  PingClock ping_clock() const { return ping_clock_; }
  const PoseStatistics& statistics(std::size_t index) const { return *statistics_[index]; }
  /// Who has sent poses by an input within the last two seconds, without those that another has come after;
  /// empty where publishers are not told apart.
  std::vector<std::string> publishers(std::size_t index, TimePoint now) const;

 private:
  /// When a publisher gave its first and its newest pose.
  struct Times {
    TimePoint first{}, last{};
  };
  using Publishers = std::map<std::string, Times>;

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
