// SPDX-License-Identifier: Apache-2.0
// A Gemini 720i client as a pure state machine: input is datagrams and time, output is datagrams and pings.
// It uses no sockets, clocks or threads. Source: protocol/gemini/README.md 1, 5, 6, 7.
//
// It follows the client libraries but retries more often. It repeats requests for everything that is lost (a
// configuration, a head, lines, a tail, requests or answers) until the ping is complete, the head begins its
// next ping, or nothing new has arrived for a second.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "protocol/common/endpoint.hpp"
#include "protocol/common/ping_job.hpp"
#include "protocol/gemini/arriving_ping.hpp"
#include "protocol/gemini/head_clock.hpp"
#include "protocol/gemini/messages.hpp"
#include "protocol/gemini/ping_assembly.hpp"
#include "protocol/gemini/response_time.hpp"

namespace sonard::gemini {

struct ClientConfig {
  std::uint16_t sonar_id = 0;  ///< ID of the head; 0: the head whose status arrives first
  Ipv4 head_address = 0;       ///< destination of commands; 0: the alternate address in the status
};

/// A datagram to send now, to port 52901 of `to`.
struct ClientDatagram {
  Ipv4 to = 0;
  std::vector<std::uint8_t> bytes;
};

/// A head from which a status has arrived.
struct HeadInfo {
  Status status;     ///< the newest
  Ipv4 address = 0;  ///< destination of commands
};

/// One finished ping.
struct ReceivedPing {
  std::uint64_t number = 0;  ///< 0, 1, 2, ... in the order of delivery
  PingHead head;
  ReceivedSamples samples;
  int lines = 0;           ///< announced by the head
  int lines_lost = 0;      ///< never arrived; zero in `samples`
  int lines_repaired = 0;  ///< arrived only when resent
  RetryCounters retries;
  TimePoint first_datagram{};
  TimePoint finished{};

  bool complete() const { return lines_lost == 0; }
};

/// Counters since construction. They only grow.
struct LinkStatistics {
  std::uint64_t datagrams = 0;        ///< arrived, of any kind
  std::uint64_t bad_datagrams = 0;    ///< undecodable, or with impossible contents
  std::uint64_t reboots = 0;          ///< the clock of the head jumped back
  std::uint64_t lines_repaired = 0;   ///< resent lines that were missing
  std::uint64_t lines_duplicate = 0;  ///< arrived again, or after their ping had ended
  std::uint64_t lines_missing = 0;    ///< never arrived, in delivered pings
  std::uint64_t pings_complete = 0;
  std::uint64_t pings_incomplete = 0;   ///< delivered with missing lines
  std::uint64_t pings_missed = 0;       ///< skipped ping IDs, and continuous pings that ended without a head
  std::uint64_t pings_unrequested = 0;  ///< answered no configuration of this client; not delivered
  std::uint64_t pings_abandoned = 0;    ///< broken off and not delivered: no head came, the head rebooted, or
                                        ///< another ping answered the same configuration
  std::uint64_t configs_sent = 0;
  std::uint64_t configs_repeated = 0;  ///< part of configs_sent: repeated because no ping came
  RetryCounters retries;
};

/// Not thread-safe: one thread calls everything. `now` never goes backwards.
class Client {
 public:
  explicit Client(const ClientConfig& config) : config_(config) {}

  /// Handles a datagram that arrived on port 52900. Counts and drops bad ones.
  void on_datagram(TimePoint now, std::span<const std::uint8_t> bytes);

  /// Starts pinging, at once or when the head is known; replaces the running programme. Run mode single:
  /// sends the next configuration when a ping has ended. Continuous: sends one configuration; the head keeps
  /// the interval. Ends after `pings` delivered pings, complete or not; 0: continues until stop().
  void start(TimePoint now, const PingConfig& config, std::uint64_t pings);
  /// Sends the stop message. Nothing is sent afterwards, so the head times out even if that message is lost.
  void stop();

  /// Runs everything that is due at `now`. Call after every other call and at next_deadline().
  void advance(TimePoint now);
  /// When to call advance() next; nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const;

  /// Datagrams due, in order. Each call empties the list.
  std::vector<ClientDatagram> take_outgoing() { return std::exchange(outgoing_, {}); }
  /// Pings that ended, in order. Each call empties the list.
  std::vector<ReceivedPing> take_pings() { return std::exchange(pings_, {}); }

  /// nullopt until the first status of the head.
  const std::optional<HeadInfo>& head() const { return head_; }
  /// Sonar IDs and alternate addresses in the statuses of heads that this client does not talk to.
  const std::map<std::uint16_t, Ipv4>& other_heads() const { return other_heads_; }
  /// True if all pings of start() are delivered, or stop() was called.
  bool finished() const { return stopped_ || (programme_ && programme_->finished()); }
  const LinkStatistics& statistics() const { return statistics_; }

 private:
  /// The arguments of start(), and its progress.
  struct Programme {
    PingConfig config;
    std::uint64_t wanted = 0;
    std::uint64_t delivered = 0;
    std::uint64_t least_head_us = 0;  ///< head clock; pings transmitted earlier answer an older configuration

    bool continuous() const { return config.mode() == RunMode::continuous; }
    bool finished() const { return wanted > 0 && delivered >= wanted; }
  };

  /// A configuration that no complete ping has answered yet.
  struct Request {
    TimePoint sent{};
    int sends = 0;
    int probes = 0;                ///< head requests since the last send
    bool timed = false;            ///< config_to_ping_ has its sample
    std::optional<TimePoint> due;  ///< next probe or repetition; nullopt while a ping is arriving
  };

  /// Identity of a ping that has ended, to recognise its late datagrams.
  struct Ended {
    std::uint8_t id = 0;
    std::optional<std::uint64_t> transmit_time_us;  ///< nullopt if its head never came
  };

  void on_report(TimePoint now, const Status& status);
  void on_report(TimePoint now, const Acknowledge& acknowledge);
  void on_report(TimePoint now, const Diagnostic& diagnostic);
  void on_report(TimePoint now, const PingHead& head);
  void on_report(TimePoint now, const PingLine& line);
  void on_report(TimePoint now, const PingTail& tail);
  template <class Other>
  void on_report(TimePoint, const Other&) {}  // a client does not need these
  void on_reboot();

  // Configurations.
  void forget_requests();
  void request_ping(TimePoint now);
  void send_config(TimePoint now);
  void on_request_due(TimePoint now);
  void await_next(TimePoint now);

  // Pings.
  /// False before the first status, because the address of the head is unknown.
  bool takes_pings() const { return head_ && programme_ && !stopped_; }
  ArrivingPing* arriving(std::uint8_t id);
  ArrivingPing* arriving_or_new(TimePoint now, std::uint8_t id);
  ArrivingPing& begin(TimePoint now, std::uint8_t id);
  void supersede(TimePoint now);
  void settle(TimePoint now, ArrivingPing& ping);
  void stop_when_finished();
  void finish(TimePoint now);
  void deliver(TimePoint now, ArrivingPing ping);
  void close_lingering(TimePoint now);
  void note_end(const ArrivingPing& ping);
  const Ended* find_ended(std::uint8_t id) const;

  void send_requests(ArrivingPing& ping);
  void send(const RetryRequest& request);
  template <class Message>
  void send(Message message);

  ClientConfig config_;
  std::optional<HeadInfo> head_;
  std::map<std::uint16_t, Ipv4> other_heads_;
  HeadClock head_clock_;
  bool diagnostic_known_ = false;
  std::optional<TimePoint> stay_alive_due_;

  std::optional<Programme> programme_;
  bool stopped_ = false;
  std::optional<Request> request_;
  /// Single mode: the next configuration waits for a second ping.
  std::optional<TimePoint> next_request_due_;
  std::optional<TimePoint> last_end_;     ///< continuous mode: end of the newest ping
  std::optional<TimePoint> silence_due_;  ///< continuous mode: the next ping must have ended by then

  std::optional<ArrivingPing> incoming_;
  std::optional<ArrivingPing> lingering_;  ///< superseded ping; accepts late datagrams until lingering_due_
  TimePoint lingering_due_{};
  std::deque<Ended> ended_;
  std::optional<std::uint8_t> last_id_;

  /// Time from a configuration to the first datagram of its ping. The head may be rendering or waiting for
  /// its rate limit, so waiting costs less than a second ping.
  ResponseTime config_to_ping_{
      {std::chrono::seconds{1}, std::chrono::milliseconds{200}, std::chrono::seconds{2}}};
  ResponseTime request_to_answer_{ArrivingPing::answer_limits};

  std::uint64_t next_number_ = 0;
  std::vector<ClientDatagram> outgoing_;
  std::vector<ReceivedPing> pings_;
  LinkStatistics statistics_;
};

}  // namespace sonard::gemini
