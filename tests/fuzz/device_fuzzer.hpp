// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes, images, faults, recorded pings and pauses against a head of any type.
// Promises: at most one job is unanswered, and it can be rendered; a cancelled job is unanswered; each record
// holds a whole ping; each ping ends once; the next deadline lies in the future; time goes on with any input.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "protocol/common/device.hpp"
#include "protocol/common/ping_cycle.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace sonard::fuzz {

/// A head, its clients and its renderer. fuzz_NAME_device.cpp derives the one of its type.
class DeviceFuzzer {
 public:
  virtual ~DeviceFuzzer() = default;

  /// Number of kinds of events that carry bytes: 0 to this, exclusive.
  virtual int byte_kinds() const = 0;
  /// Boots the head.
  void start() { step(TimePassed{}); }
  void play(const Event& event) {
    run_until(now_ + event.delay);
    happen(event);
  }

 protected:
  virtual Device& device() = 0;
  virtual const PingCounters& counters() const = 0;
  virtual bool plays_back() const = 0;
  /// Beams of an image whose job does not say how many.
  virtual int beams() const { return 1; }
  /// Jobs of more bins are answered by PingNotRendered, because they take time and test no other path.
  virtual int most_bins() const = 0;

  /// Steps the head according to the kind of event, at now().
  virtual void happen(const Event& event) = 0;
  virtual void check_message(const Outgoing& outgoing) = 0;
  virtual void check_job(const PingJob&) const {}
  virtual void check_record(const PingRecord&) const {}
  /// Called after each step, before its messages are checked.
  virtual void stepped(const sonard::Event&) {}

  /// For check_job() of a head with one beam.
  void check_line_job(const PingJob& job) const {
    require(job.bins() <= most_bins(), "a job can be rendered");
    constexpr double half_a_turn = std::numbers::pi + 1e-9;  // with rounding
    require(std::abs(job.bearing_rad) <= half_a_turn, "a job has a bearing of one turn");
    require(job.transmit_time <= now(), "a job is not ahead of its time");
  }

  TimePoint now() const { return now_; }
  const Actions& last() const { return last_; }
  void step(const sonard::Event& event);
  /// NextPingDue, if the head waits for it.
  void begin_next();
  /// Answers the outstanding job, if there is one.
  void answer_job(bool rendered);

 private:
  void run_until(TimePoint target);

  TimePoint now_{};
  Actions last_;
  std::optional<PingJob> job_;  ///< outstanding
};

/// The fuzzer of the device under test. `flags` selects a configuration.
std::unique_ptr<DeviceFuzzer> make_device_fuzzer(unsigned flags);

}  // namespace sonard::fuzz
