// SPDX-License-Identifier: Apache-2.0
// Times and bearings of a head's pings, and the lines that it sends. Source: docs/protocols/micron.md 7.4, 8.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/micron/device_config.hpp"
#include "protocol/micron/device_counters.hpp"
#include "protocol/micron/line_timing.hpp"
#include "protocol/micron/motor.hpp"
#include "protocol/micron/sweep.hpp"

namespace sonard::micron {

/// The part of a Device that turns and pings.
///
/// A ping is *owed* from its request on and *acquired* from its transmission on, when its job is issued. It
/// ends when its line is sent, fails, or is cancelled by new parameters. Cancelled ones stay owed. At most
/// one ping is acquired: even in full duplex a line is complete before the next ping transmits.
class Scanner {
 public:
  /// Starts centred. `config` and `counters` must outlive the scanner.
  Scanner(const DeviceConfig& config, DeviceCounters& counters);

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
  /// See Actions::next_ping.
  std::optional<NextPing> next_ping() const;
  void next_ping_due() { due_ = true; }
  /// Sets the next recorded ping; a ping without a line in its `wire` counts as nullopt.
  void feed(const std::optional<ReplayedPing>& ping);

  /// Appends the frames due at `now` to `out`.
  void advance(TimePoint now, std::vector<std::vector<std::uint8_t>>& out);
  std::optional<TimePoint> next_deadline() const;
  std::optional<PingJob> take_job();
  /// The line that was sent since the last call; advance() sends at most one.
  std::optional<PingRecord> take_record() { return std::exchange(record_, std::nullopt); }
  /// See Actions::cancelled.
  std::optional<std::uint64_t> cancelled() const { return ping_ ? std::nullopt : unanswered_; }

  const std::optional<HeadCommand>& parameters() const { return parameters_; }
  int owed() const { return owed_; }
  bool centred(TimePoint now) const { return now >= centred_at_; }
  int position(TimePoint now) const { return motor_.position(now); }
  bool turning(TimePoint now) const { return motor_.turning(now); }

 private:
  std::chrono::nanoseconds wanted_period() const;
  struct FedPing {
    ReplayedPing ping;
    HeadData line;
  };
  struct Ping {
    std::uint64_t number = 0;
    TimePoint transmit_time{};
    TimePoint line_due{};  ///< earliest time at which the line leaves
    HeadData line;         ///< without its data
    RecordedSettings settings;
    double bearing_rad = 0.0;
    std::vector<std::uint8_t> samples;  ///< empty: not rendered yet
  };

  void settle(TimePoint now);
  void take_up_position(TimePoint begin);
  std::optional<TimePoint> ping_possible() const;
  std::optional<TimePoint> ping_due() const;
  std::optional<TimePoint> line_due() const;
  TimePoint line_due_of(TimePoint transmit_time, std::chrono::nanoseconds line_after) const;
  void start_ping(TimePoint now, TimePoint due);
  void aim(TimePoint transmit_time);
  void repeat(TimePoint transmit_time, const FedPing& fed);
  void keep_settings(const PingJob& job);
  HeadData make_line() const;
  std::vector<std::uint8_t> bins_of(const Ping& ping) const;
  PingRecord record_of(const Ping& ping, const HeadData& line) const;
  void send_line(std::vector<std::vector<std::uint8_t>>& out);
  void end_ping();
  TimePoint time_of_next_ping();
  void cancel_ping();
  bool answered(TimePoint now, std::uint64_t number);

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
  std::optional<FedPing> fed_;

  // Pings.
  bool due_ = false;
  std::uint64_t next_ping_number_ = 0;
  std::optional<Ping> ping_;
  std::optional<PingRecord> record_;         ///< not yet taken
  std::optional<PingJob> job_;               ///< not yet taken
  std::optional<std::uint64_t> unanswered_;  ///< number of the job that is taken but not yet answered
  TimePoint free_since_{};                   ///< when the last job was answered
  TimePoint next_ping_at_{};                 ///< earliest time of the next ping by the line period
  TimePoint link_free_at_{};
};

}  // namespace sonard::micron
