// SPDX-License-Identifier: Apache-2.0
// Run modes, rate limits, transmission and retries of a head's pings.
// Source: protocol/gemini/README.md 7.3, 8.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/common/ping_cycle.hpp"
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
/// *Under way* (PingCycle): its transmit time is fixed, and its image is pending or waits for the wire. *On
/// the wire*: from its head on; it serves retries until the next head. A ping may be under way while the last
/// one is on the wire (only if DeviceConfig::render_lead allows) or is still being repaired.
class Pinger {
 public:
  /// `config` and `counters` must outlive the pinger. The clock of the head is 0 at `boot_time`.
  Pinger(const DeviceConfig& config, DeviceCounters& counters, TimePoint boot_time);

  void configure(TimePoint now, const PingConfig& config);
  void on_retry(TimePoint now, const RetryRequest& request);
  void on_trigger(TimePoint now);
  void on_image(TimePoint now, const PingImage& image);
  void on_image_failed(TimePoint now, std::uint64_t number) { cycle_.on_image_failed(now, number); }
  void set_inter_packet_gap(std::chrono::nanoseconds gap) { pacer_.set_gap(gap); }
  void set_out_of_water(bool out_of_water) { out_of_water_ = out_of_water; }
  void feed(const std::optional<ReplayedPing>& ping);
  void next_ping_due() { cycle_.grant(); }

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
  /// Sets the members of the actions that concern pings. advance() begins to send at most one ping.
  void report(Actions& actions);

  /// True if the head does not ping because it is out of the water and the configuration does not allow it.
  bool stopped_by_air() const { return out_of_water_ && !pings_out_of_water_; }

 private:
  /// A ping that starts as soon as the rules allow.
  struct Wanted {
    PingPlan plan;
    TimePoint asked_at{};
  };
  /// The ping under way.
  struct Ping {
    PingPlan plan;
    TimePoint asked_at{};
    TimePoint earliest_start_before{};  ///< earlier value of earliest_start_, in case this ping never begins
    double gain_percent = 0.0;          ///< for logs; below 0: unknown
    std::optional<EncodedPing> encoded = std::nullopt;  ///< set at the arrival of the image
    PingRecord record = {};                             ///< set at the arrival of the image
  };

  const PingPlan* wanted_plan() const;
  std::chrono::nanoseconds period_of(const PingPlan& plan) const;
  std::chrono::nanoseconds wanted_period(const PingPlan& plan) const;
  bool sending() const { return transmission_ && !transmission_->finished(); }
  std::optional<TimePoint> next_start() const;
  std::optional<TimePoint> ping_due() const;
  std::optional<TimePoint> head_due() const;
  std::optional<TimePoint> datagram_due() const;
  void begin_ping(TimePoint now);
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

  // Under way.
  TimePoint earliest_start_;  ///< earliest start of the next ping by the rate rules
  PingCycle cycle_;
  Ping ping_;

  // On the wire.
  std::optional<PingTransmission> transmission_;
  RetryQueue retries_;
  std::optional<TimePoint> last_retry_arrival_;   ///< for the ping in transmission_
  std::optional<TimePoint> last_retry_activity_;  ///< arrival or service
};

}  // namespace sonard::gemini
