// SPDX-License-Identifier: Apache-2.0
// When and where a head pings, and what it sends for it. Source: docs/protocols/ping360.md 3.2, 3.3, 3.7.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/ping360/device_config.hpp"
#include "protocol/ping360/device_counters.hpp"
#include "protocol/ping360/ping_form.hpp"
#include "protocol/ping360/sweep.hpp"

namespace sonard::ping360 {

/// The part of a Device that turns and pings.
///
/// Its *work* is the command that is being done or, once there is none, the next ping of the scan: the head
/// turns to where the work is to be done, pings there, and sends. There is one work at a time. A ping is
/// *acquired* from its transmission on, when its job goes out.
class Scanner {
 public:
  /// A message for the client that has asked for it.
  struct Answer {
    Peer to;
    std::vector<std::uint8_t> frame;
  };

  /// At angle 0, with the settings of a head at boot. `config` and `counters` outlive the scanner.
  Scanner(const DeviceConfig& config, DeviceCounters& counters);

  /// Forgets everything but the job that is still to be answered, and stands as at boot.
  void restart(TimePoint now);
  /// Both take commands within their limits (limits.hpp).
  /// Ends the scan. Queues the command, unless it repeats the last unanswered command of this client: then
  /// one answer serves both (3.2).
  void command(TimePoint now, const Peer& asker, const Transducer& command);
  /// Starts a scan. If this client's running scan has the same command, that scan goes on (3.3).
  void scan(TimePoint now, const Peer& starter, const AutoTransmit& command);
  void end_scan(TimePoint now);
  /// Drops all that is to be done.
  void stop(TimePoint now);
  /// Drops what this client has asked for.
  void forget(TimePoint now, const Peer& client);

  void on_image(TimePoint now, const PingImage& image);
  void on_image_failed(TimePoint now, std::uint64_t number);
  /// See Actions::next_ping.
  std::optional<NextPing> next_ping() const;
  void grant() { granted_ = true; }
  /// Nothing, too, where `ping` does not say how it travelled.
  void feed(const std::optional<RecordedPing>& ping);

  /// Appends the messages due at `now` to `out`, from the device `id`.
  void advance(TimePoint now, std::uint8_t id, std::vector<Answer>& out);
  std::optional<TimePoint> next_deadline() const;
  std::optional<PingJob> take_job();
  /// The ping that has left since the last call; advance() sends one at most.
  std::optional<PingRecord> take_record() { return std::exchange(record_, std::nullopt); }
  /// See Actions::cancelled.
  std::optional<std::uint64_t> cancelled() const { return ping_ ? std::nullopt : unanswered_; }

  /// The last ping, with its own settings and angle; before the first one and after a mere move how the head
  /// stands, without samples. Valid until the next call of another function.
  DeviceData state(TimePoint now) const;
  /// The last ping of the scan that goes on, without data before the first; nullopt: there is no scan.
  std::optional<AutoDeviceData> scan_state(TimePoint now) const;
  /// Who has begun the scan that goes on, and how.
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
    PingForm asked;  ///< by the client
    PingForm form;   ///< of the answer: as asked, or as recorded
    bool transmit = true;
    TimePoint wanted{};                 ///< not before this
    TimePoint there_at{};               ///< when the head has turned to it
    std::chrono::nanoseconds period{};  ///< from the last ping to this one
  };
  struct Ping {
    std::uint64_t number = 0;
    TimePoint transmit_time{};
    TimePoint send_due{};
    RecordedSettings settings;
    double bearing_rad = 0.0;
    std::vector<std::uint8_t> samples;  ///< empty: not rendered yet
  };
  struct FedPing {
    RecordedPing ping;
    PingForm form;
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
  std::optional<TimePoint> ping_possible() const;
  std::optional<TimePoint> ping_due() const;
  void start_ping(TimePoint now, TimePoint due);
  PingJob repeat(const FedPing& fed);
  void fail_ping(TimePoint now);
  void send_ping(std::uint8_t id, std::vector<Answer>& out);
  void keep_record(std::uint8_t id);
  bool answered(TimePoint now, std::uint64_t number);

  const DeviceConfig& config_;
  DeviceCounters& counters_;

  // Where it looks: it turns evenly from `from_` by `way_`.
  int from_ = 0;
  int way_ = 0;
  TimePoint turn_begin_{};
  TimePoint turn_end_{};

  // What it was told.
  std::deque<Command> queue_;
  std::optional<Scan> scan_;
  std::optional<FedPing> fed_;

  // What it does.
  DeviceData settings_;       ///< of its present or last work
  DeviceData last_settings_;  ///< of the last ping
  std::vector<std::uint8_t> last_samples_;
  std::optional<Work> work_;
  std::optional<Ping> ping_;
  bool granted_ = false;
  std::uint64_t next_ping_number_ = 0;
  std::optional<PingRecord> record_;         ///< not yet taken
  std::optional<PingJob> job_;               ///< not yet taken
  std::optional<std::uint64_t> unanswered_;  ///< number of the job taken and not yet answered
  TimePoint busy_until_{};                   ///< with the last work, by the pace of the head
  TimePoint free_since_{};                   ///< when the last job was answered
};

/// Whether two messages are from one client.
inline bool same_client(const Peer& a, const Peer& b) {
  return a.channel == b.channel && a.remote == b.remote;
}

}  // namespace sonard::ping360
