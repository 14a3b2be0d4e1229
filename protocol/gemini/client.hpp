// SPDX-License-Identifier: Apache-2.0
// A Gemini 720i client as a pure state machine: input is datagrams and time, output is datagrams and pings.
// It uses no sockets, clocks or threads. Source: docs/protocols/gemini.md 1, 5, 6, 7.
//
// It follows the client libraries but retries more often. It repeats requests for everything that is lost (a
// configuration, a head, lines, a tail, requests or answers) until the ping is complete, the head begins its
// next ping, or nothing new has arrived for a second.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/endpoint.hpp"
#include "protocol/common/ping_job.hpp"
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

/// Retry requests by kind, in datagrams. A request sent in two copies counts twice.
struct RetryCounters {
  std::uint64_t head = 0, lines = 0, tail = 0;

  std::uint64_t total() const { return head + lines + tail; }
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
  std::uint64_t datagrams = 0;      ///< arrived, of any kind
  std::uint64_t bad_datagrams = 0;  ///< undecodable, or with impossible contents
  std::uint64_t other_heads = 0;    ///< from another sonar ID
  std::uint64_t statuses = 0;
  std::uint64_t acknowledges = 0;
  std::uint64_t reboots = 0;          ///< the clock of the head jumped back
  std::uint64_t lines_received = 0;   ///< new lines, without duplicates
  std::uint64_t lines_repaired = 0;   ///< part of lines_received: resent lines
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
  explicit Client(const ClientConfig& config);

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
  std::vector<ClientDatagram> take_outgoing();
  /// Pings that ended, in order. Each call empties the list.
  std::vector<ReceivedPing> take_pings();

  /// nullopt until the first status of the head.
  const std::optional<HeadInfo>& head() const { return head_; }
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

  /// The ping that is arriving.
  struct Incoming {
    Incoming(std::uint8_t id, TimePoint now)
        : assembly(id), first_datagram(now), last_arrival(now), progress(now), marked_at(now) {}

    /// False if `head` belongs to another ping with an equal ID: then the transmit times differ.
    bool may_have(const PingHead& head) const {
      return !assembly.head() || assembly.head()->transmit_time_us == head.transmit_time_us;
    }

    PingAssembly assembly;
    TimePoint first_datagram;
    TimePoint last_arrival;  ///< of the last datagram of this ping, or of the last request
    TimePoint progress;      ///< of the last datagram with new content
    bool requested = true;   ///< false: answers no configuration of ours; only watched until it ends
    bool pass_over = false;  ///< the first pass is over: the head now answers requests
    bool has_tail = false;
    bool head_asked = false;
    bool asked_ahead = false;
    int highest = -1;     ///< highest line number of the first pass
    TimePoint marked_at;  ///< when `marked` was the highest line
    int marked = 0;       ///< missing lines below it are lost, not late
    int asked_to = 0;     ///< missing lines below it have been requested
    int fruitless = 0;    ///< rounds of requests without an answer
    int lines_repaired = 0;
    RetryCounters retries;
    std::optional<TimePoint> asked;  ///< first request since the last answer
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

  void meet_head(TimePoint now);
  void on_reboot();

  // Configurations.
  void request_ping(TimePoint now);
  void send_config(TimePoint now);
  void on_request_due(TimePoint now);
  void await_next(TimePoint now);
  void stop_when_finished();
  void watch_for_silence(TimePoint now);

  // The ping that is arriving.
  /// False before the first status, because the address of the head is unknown.
  bool takes_pings() const { return head_ && programme_ && !stopped_; }
  Incoming* find_incoming(std::uint8_t id);
  Incoming* incoming_for(TimePoint now, std::uint8_t id);
  Incoming& begin(TimePoint now, std::uint8_t id);
  void adopt_head(TimePoint now, Incoming& ping, const PingHead& head);
  void on_answer(TimePoint now, Incoming& ping);
  void end_pass(Incoming& ping);
  void follow_first_pass(TimePoint now, Incoming& ping, int number);
  void ask_unasked(Incoming& ping, int end);
  void ask_again(TimePoint now, Incoming& ping);
  TimePoint due(const Incoming& ping) const;
  void on_incoming_due(TimePoint now);
  void settle(TimePoint now);
  void supersede(TimePoint now);
  void finish(TimePoint now);
  void deliver(TimePoint now, Incoming ping);
  void close_lingering(TimePoint now);
  void note_end(const Incoming& ping);
  const Ended* find_ended(std::uint8_t id) const;

  void ask(Incoming* ping, RetryKind kind, LineRange range, int copies);
  template <class Message>
  void send(Message message);

  ClientConfig config_;
  std::optional<HeadInfo> head_;
  HeadClock head_clock_;
  bool diagnostic_known_ = false;
  std::optional<TimePoint> stay_alive_due_;

  std::optional<Programme> programme_;
  bool stopped_ = false;
  std::optional<Request> request_;
  std::optional<TimePoint>
      next_request_due_;                  ///< single mode: the next configuration waits for a second ping
  std::optional<TimePoint> last_end_;     ///< continuous mode: end of the newest ping
  std::optional<TimePoint> silence_due_;  ///< continuous mode: the next ping must have ended by then

  std::optional<Incoming> incoming_;
  std::optional<Incoming> lingering_;  ///< superseded ping; accepts late datagrams until lingering_due_
  TimePoint lingering_due_{};
  std::deque<Ended> ended_;
  std::optional<std::uint8_t> last_id_;

  ResponseTime config_to_ping_;
  ResponseTime request_to_answer_;

  std::uint64_t next_number_ = 0;
  std::vector<ClientDatagram> outgoing_;
  std::vector<ReceivedPing> pings_;
  LinkStatistics statistics_;
};

}  // namespace sonard::gemini
