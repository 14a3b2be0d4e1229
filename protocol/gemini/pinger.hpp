// SPDX-License-Identifier: Apache-2.0
// Run modes, rate limits, transmission and retries of a head's pings.
// Source: docs/protocols/gemini.md 7.3, 8.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/common/shared_bytes.hpp"
#include "protocol/gemini/device_config.hpp"
#include "protocol/gemini/device_counters.hpp"
#include "protocol/gemini/pacer.hpp"
#include "protocol/gemini/ping_plan.hpp"
#include "protocol/gemini/ping_transmission.hpp"
#include "protocol/gemini/retry_queue.hpp"

namespace sonard::gemini {

/// The part of a Device that pings. It uses no addresses: the Device sends its datagrams to the client.
///
/// A ping has three stages. *Wanted*: a configuration, the interval or a trigger edge requests it.
/// *Acquired*: its transmit time is fixed, its job has been issued, its image is pending. *On the wire*: from
/// its head on; it serves retries until the next head. A ping may be acquired while the last one is on the
/// wire (only if DeviceConfig::render_lead allows) or is still being repaired.
class Pinger {
 public:
  /// `config` and `counters` must outlive the pinger. The clock of the head is 0 at `boot_time`.
  Pinger(const DeviceConfig& config, DeviceCounters& counters, TimePoint boot_time);

  void configure(TimePoint now, const PingConfig& config);
  void on_retry(TimePoint now, const RetryRequest& request);
  void on_trigger(TimePoint now);
  void on_image(TimePoint now, const PingImage& image);
  void on_image_failed(std::uint64_t number);
  void set_inter_packet_gap(std::chrono::nanoseconds gap) { pacer_.set_gap(gap); }
  void set_out_of_water(bool out_of_water) { out_of_water_ = out_of_water; }
  void feed(const std::optional<ReplayedPing>& ping) { fed_ = ping; }
  /// See Actions::next_ping.
  std::optional<NextPing> next_ping() const;
  void next_ping_due() { due_ = true; }

  /// Stops pinging because the client goes offline. Finishes the ping on the wire.
  void stop();
  /// Stops sending because the client is silent. A continuous or triggered programme waits for resume().
  void suspend();
  void resume(TimePoint now);
  /// True if a programme waits for resume().
  bool paused() const { return suspended_ && programme_; }
  /// Reboots the head. Keeps only the unanswered job and the count of pings.
  void reset(TimePoint boot_time);

  /// Appends the datagrams due at `now` to `out`.
  void advance(TimePoint now, std::vector<SharedBytes>& out);
  std::optional<TimePoint> next_deadline() const;
  std::optional<PingJob> take_job();
  /// The ping that went onto the wire since the last call; advance() begins at most one.
  std::optional<PingRecord> take_record() { return std::exchange(record_, std::nullopt); }
  /// See Actions::cancelled.
  std::optional<std::uint64_t> cancelled() const { return acquisition_ ? std::nullopt : unanswered_; }

  /// True if the head does not ping because it is out of the water and the configuration does not allow it.
  bool stopped_by_air() const { return out_of_water_ && !pings_out_of_water_; }

 private:
  /// A ping that starts as soon as the rules allow.
  struct Wanted {
    PingPlan plan;
    TimePoint asked_at{};
  };
  struct Acquisition {
    PingPlan plan;
    std::uint64_t number = 0;
    TimePoint transmit_time{};
    TimePoint asked_at{};
    TimePoint earliest_start_before{};  ///< earlier value of earliest_start_, in case this ping never begins
    double gain_percent = 0.0;          ///< for logs; below 0: unknown
    std::optional<EncodedPing> encoded = std::nullopt;  ///< set at the arrival of the image
    PingRecord record = {};                             ///< set at the arrival of the image
    TimePoint ready_at{};                               ///< time of arrival of the image
  };

  std::uint64_t clock_us(TimePoint time) const;
  const PingPlan* wanted_plan() const;
  std::chrono::nanoseconds period_of(const PingPlan& plan) const;
  std::chrono::nanoseconds wanted_period(const PingPlan& plan) const;
  bool sending() const { return transmission_ && !transmission_->finished(); }
  TimePoint earliest_by_rate() const;
  std::optional<TimePoint> next_transmit_time() const;
  std::optional<TimePoint> acquisition_due() const;
  std::optional<TimePoint> head_due() const;
  std::optional<TimePoint> datagram_due() const;
  void acquire(TimePoint now);
  void cancel_acquisition();
  void put_on_wire();
  void send_lines(TimePoint now, std::vector<SharedBytes>& out);
  void serve_retries(TimePoint now, std::vector<SharedBytes>& out);
  SharedBytes resend(const RetryQueue::Resend& what);
  void drop_retries(int line_count);

  const DeviceConfig& config_;
  DeviceCounters& counters_;
  TimePoint boot_time_;
  Pacer pacer_;

  // Wanted.
  std::optional<Wanted> single_;       ///< a single ping or a trigger edge
  std::optional<PingPlan> programme_;  ///< continuous or triggered
  TimePoint programme_due_{};          ///< when the next continuous ping is due
  bool suspended_ = false;
  bool out_of_water_ = false;
  bool pings_out_of_water_ = false;  ///< from the newest configuration
  std::optional<ReplayedPing> fed_;
  bool due_ = false;

  // Acquired.
  std::uint64_t next_ping_number_ = 0;
  TimePoint earliest_start_;  ///< earliest start of the next ping by the rate rules
  std::optional<Acquisition> acquisition_;
  std::optional<PingJob> job_;               ///< not yet taken
  std::optional<std::uint64_t> unanswered_;  ///< number of the job that is taken but not yet answered

  // On the wire.
  std::optional<PingTransmission> transmission_;
  std::optional<PingRecord> record_;  ///< not yet taken
  RetryQueue retries_;
  std::optional<TimePoint> last_retry_arrival_;   ///< for the ping in transmission_
  std::optional<TimePoint> last_retry_activity_;  ///< arrival or service
};

}  // namespace sonard::gemini
