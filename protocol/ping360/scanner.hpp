// SPDX-License-Identifier: Apache-2.0
// Times and angles of a head's pings, and its answers. Source: protocol/ping360/README.md 3.2, 3.3, 3.7.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "protocol/common/ping_cycle.hpp"
#include "protocol/ping360/device_config.hpp"
#include "protocol/ping360/device_counters.hpp"
#include "protocol/ping360/ping_form.hpp"
#include "protocol/ping360/sweep.hpp"

namespace sonard::ping360 {

/// The part of a Device that turns and pings.
///
/// Its *work* is the current command or, if there is no command, the next ping of the scan: the head turns to
/// the angle, pings there and sends. There is one work at a time.
class Scanner {
 public:
  /// A message for the client that requested it.
  struct Answer {
    Peer to;
    std::vector<std::uint8_t> frame;
  };

  /// Starts at angle 0 with the settings of a head at boot. `config` and `counters` must outlive the scanner.
  /// The clock of jobs is 0 at `power_up`.
  Scanner(const DeviceConfig& config, TimePoint power_up, DeviceCounters& counters);

  /// Restores the state at boot; keeps only the unanswered job.
  void restart(TimePoint now);
  // command() and scan() require commands within their limits (limits.hpp).
  /// Ends the scan and queues the command. If it repeats the last unanswered command of this client, it is
  /// not queued: one answer serves both (3.2).
  void command(TimePoint now, const Peer& asker, const Transducer& command);
  /// Starts a scan. If this client's running scan has an equal command, that scan continues (3.3).
  void scan(TimePoint now, const Peer& starter, const AutoTransmit& command);
  void end_scan(TimePoint now);
  /// Drops all work, queued commands and the scan.
  void stop(TimePoint now);
  /// Drops the work, commands and scan of this client.
  void forget(TimePoint now, const Peer& client);

  void on_image(TimePoint now, const PingImage& image);
  void on_image_failed(TimePoint now, std::uint64_t number);
  void next_ping_due() { cycle_.grant(); }
  /// Sets the next recorded ping; a ping without a valid `wire` counts as nullopt.
  void feed(const std::optional<ReplayedPing>& ping);

  /// Appends the messages due at `now` to `out`, from the device `id`.
  void advance(TimePoint now, std::uint8_t id, std::vector<Answer>& out);
  std::optional<TimePoint> next_deadline() const;
  /// Sets the members of the actions that concern pings. advance() sends at most one ping.
  void report(Actions& actions);

  /// The last ping with its settings and angle. Before the first ping and after a move without a ping: the
  /// current settings and angle without samples. Valid until the next call of another function.
  DeviceData state(TimePoint now) const;
  /// The last ping of the running scan, without data before the first ping; nullopt if there is no scan.
  std::optional<AutoDeviceData> scan_state(TimePoint now) const;
  /// The client that started the running scan, and its command.
  std::optional<std::pair<Peer, AutoTransmit>> running_scan() const;

 private:
  struct Command {
    Peer asker;
    Transducer command;
    TimePoint received{};
  };
  struct Scan {
    Peer starter;
    AutoTransmit command;
    Sweep sweep;
    TimePoint next_from{};
    bool has_pinged = false;
  };
  struct Work {
    Peer asker;
    PingForm asked;  ///< requested by the client
    PingForm form;   ///< of the answer: as requested, or as recorded
    bool transmit = true;
    TimePoint wanted{};                 ///< earliest time
    TimePoint there_at{};               ///< when the head has turned to the angle
    std::chrono::nanoseconds period{};  ///< from the last ping to this one
  };
  /// The ping under way.
  struct Ping {
    TimePoint send_due{};
    std::vector<std::uint8_t> samples;  ///< set at the arrival of the image
  };

  bool is_repeated(const Peer& asker, const Transducer& command) const;
  std::chrono::nanoseconds scaled(std::chrono::nanoseconds time) const;
  int position(TimePoint now) const;
  void place(int angle);
  std::chrono::nanoseconds turn_to(int angle, TimePoint begin);
  std::optional<Work> next_work();
  void begin_work();
  void end_work(TimePoint end);
  void abandon_work(TimePoint now);
  std::optional<TimePoint> next_start() const;
  std::optional<TimePoint> ping_due() const;
  void begin_ping(TimePoint now, TimePoint due);
  PingJob repeat(const ReplayedPing& fed);
  void end_failed_work(TimePoint now);
  void send_ping(std::uint8_t id, std::vector<Answer>& out);

  const DeviceConfig& config_;
  DeviceCounters& counters_;

  // Angle: the head turns at constant speed from `from_` by `way_`.
  int from_ = 0;
  int way_ = 0;
  TimePoint turn_begin_{};
  TimePoint turn_end_{};

  // Commands.
  std::deque<Command> queue_;
  std::optional<Scan> scan_;

  // Work.
  DeviceData settings_;       ///< of the current or last work
  DeviceData last_settings_;  ///< of the last ping
  std::vector<std::uint8_t> last_samples_;
  std::optional<Work> work_;
  PingCycle cycle_;
  Ping ping_;
  TimePoint busy_until_{};  ///< end of the last work by the timing of the head
};

}  // namespace sonard::ping360
