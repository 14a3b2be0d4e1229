// SPDX-License-Identifier: Apache-2.0
// Times and bearings of a head's pings, and the lines that it sends. Source:
// protocol/micron/README.md 7.4, 8.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/common/ping_cycle.hpp"
#include "protocol/micron/device_config.hpp"
#include "protocol/micron/device_counters.hpp"
#include "protocol/micron/line_timing.hpp"
#include "protocol/micron/motor.hpp"
#include "protocol/micron/sweep.hpp"

namespace sonard::micron {

/// The part of a Device that turns and pings.
///
/// A ping is *owed* from its request on and *under way* (PingCycle) from its transmission on. It ends when
/// its line is sent, fails, or is cancelled by new parameters. Cancelled ones stay owed. Even in full duplex
/// a line is complete before the next ping transmits.
class Scanner {
 public:
  /// Starts centred. `config` and `counters` must outlive the scanner. The clock of jobs is 0 at `power_up`.
  Scanner(const DeviceConfig& config, TimePoint power_up, DeviceCounters& counters);

  /// Restarts after power-up or a reboot: keeps only the unanswered job, turns to the centre from `begin` on.
  void restart(TimePoint now, TimePoint begin);

  void configure(TimePoint now, const HeadCommand& parameters);
  /// set_gain(), reverse() and request() require parameters().
  void set_gain(const GainBlock& values);
  void reverse();
  void request(TimePoint now);

  void on_image(TimePoint now, const PingImage& image);
  void on_image_failed(TimePoint now, std::uint64_t number);
  void lose_step() { motor_error_ = true; }
  void next_ping_due() { cycle_.grant(); }
  /// Sets the next recorded ping; a ping without a line in its `wire` counts as nullopt.
  void feed(const std::optional<ReplayedPing>& ping);

  /// Appends the frames due at `now` to `out`.
  void advance(TimePoint now, std::vector<std::vector<std::uint8_t>>& out);
  std::optional<TimePoint> next_deadline() const;
  /// Sets the members of the actions that concern pings. advance() sends at most one line.
  void report(Actions& actions);

  const std::optional<HeadCommand>& parameters() const { return parameters_; }
  int owed() const { return owed_; }
  bool centred(TimePoint now) const { return now >= centred_at_; }
  int position(TimePoint now) const { return motor_.position(now); }
  bool turning(TimePoint now) const { return motor_.turning(now); }

 private:
  /// The ping under way.
  struct Ping {
    TimePoint line_due{};               ///< earliest time at which the line leaves
    HeadData line;                      ///< without its data
    std::vector<std::uint8_t> samples;  ///< set at the arrival of the image
  };

  void settle(TimePoint now);
  void take_up_position(TimePoint begin);
  std::chrono::nanoseconds wanted_period() const;
  std::optional<TimePoint> next_start() const;
  std::optional<TimePoint> ping_due() const;
  std::optional<TimePoint> line_due() const;
  TimePoint line_due_of(TimePoint transmit_time, std::chrono::nanoseconds line_after) const;
  void begin_ping(TimePoint now, TimePoint due);
  PingJob aim(TimePoint transmit_time);
  PingJob repeat(TimePoint transmit_time, const ReplayedPing& fed);
  HeadData make_line() const;
  std::vector<std::uint8_t> bins() const;
  PingRecord record_of(const HeadData& line) const;
  void send_line(std::vector<std::vector<std::uint8_t>>& out);
  void end_ping();
  TimePoint time_of_next_ping();

  const DeviceConfig& config_;
  DeviceCounters& counters_;

  // Direction.
  Motor motor_;
  Sweep sweep_;
  TimePoint centred_at_{};
  bool placed_ = true;  ///< centred, and in the sector of its parameters if it has any
  TimePoint ready_at_{};

  // Commands.
  std::optional<HeadCommand> parameters_;
  TimePoint configured_at_{};
  bool motor_error_ = false;
  int owed_ = 0;  ///< number of requested lines
  TimePoint owed_since_{};

  // Pings.
  PingCycle cycle_;
  Ping ping_;
  TimePoint next_ping_at_{};  ///< earliest time of the next ping by the line period
  TimePoint link_free_at_{};
};

}  // namespace sonard::micron
