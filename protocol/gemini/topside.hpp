// SPDX-License-Identifier: Apache-2.0
// The topside's side of a Gemini 720i as a pure state machine: datagrams and time go in; datagrams and pings
// come out. It knows no sockets, clocks or threads. Source: docs/protocols/gemini.md 1, 5, 6, 7.
//
// It talks as the libraries of a vehicle do, and asks harder: whatever is lost on the way (a configuration, a
// head, lines, a tail, the request for any of them, or what was sent in answer) is asked for again until the
// ping is complete, the head begins its next ping, or nothing at all has come for a second.
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

struct TopsideConfig {
  std::uint16_t sonar_id = 0;  ///< the head to talk to; 0: the first whose status arrives
  Ipv4 head_address = 0;       ///< where commands go; 0: the alternate address that the status names
};

/// A datagram to send now, to port 52901 of `to`.
struct TopsideDatagram {
  Ipv4 to = 0;
  std::vector<std::uint8_t> bytes;
};

/// A head that made itself known.
struct HeadInfo {
  Status status;     ///< the newest
  Ipv4 address = 0;  ///< where commands go
};

/// Why requests of a ping were sent, in datagrams. A request sent twice in one go counts twice.
struct RetryCounters {
  std::uint64_t head = 0, lines = 0, tail = 0;

  std::uint64_t total() const { return head + lines + tail; }
};

/// One ping as it ended.
struct ReceivedPing {
  std::uint64_t number = 0;  ///< 0, 1, 2, ... in the order of delivery
  PingHead head;
  PingSamples samples;
  int lines = 0;           ///< announced by the head
  int lines_lost = 0;      ///< never arrived: zero in `samples`
  int lines_repaired = 0;  ///< arrived only as re-sent ones
  RetryCounters retries;
  TimePoint first_datagram{};
  TimePoint finished{};

  bool complete() const { return lines_lost == 0; }
};

/// Counters since construction. They only grow.
struct LinkStatistics {
  std::uint64_t datagrams = 0;      ///< arrived, of any kind
  std::uint64_t bad_datagrams = 0;  ///< could not be read, or say what cannot be
  std::uint64_t other_heads = 0;    ///< from another sonar ID
  std::uint64_t statuses = 0;
  std::uint64_t acknowledges = 0;
  std::uint64_t reboots = 0;          ///< the clock of the head jumped back
  std::uint64_t lines_received = 0;   ///< that filled a gap
  std::uint64_t lines_repaired = 0;   ///< of those: re-sent ones
  std::uint64_t lines_duplicate = 0;  ///< arrived once more, or after their ping had ended
  std::uint64_t lines_missing = 0;    ///< lost for good, in delivered pings
  std::uint64_t pings_complete = 0;
  std::uint64_t pings_incomplete = 0;  ///< delivered with lines missing
  std::uint64_t pings_missed = 0;      ///< IDs that were skipped: nothing at all arrived of those pings
  std::uint64_t pings_unrequested =
      0;                              ///< seen, but answering no configuration of this topside; not delivered
  std::uint64_t pings_abandoned = 0;  ///< broken off and not delivered: another ping came to answer the same
                                      ///< configuration, or no head came at all
  std::uint64_t configs_sent = 0;
  std::uint64_t configs_repeated = 0;  ///< of those: because no ping came
  RetryCounters retries;
};

/// Not thread-safe: one thread calls everything. `now` never goes backwards.
class Topside {
 public:
  explicit Topside(const TopsideConfig& config);

  /// A datagram that arrived on port 52900. Bad ones are counted and dropped.
  void on_datagram(TimePoint now, std::span<const std::uint8_t> bytes);

  /// Starts to ping, at once or as soon as the head is known; replaces what was going on. Run mode single:
  /// the next configuration leaves when a ping has ended. Continuous: one configuration, the head keeps the
  /// time. Ends after `pings` delivered pings, complete or not; 0: continues until stop().
  void start(TimePoint now, const PingConfig& config, std::uint64_t pings);
  /// Tells the head to stop; from here on nothing is sent, so that the head falls silent even if that is
  /// lost.
  void stop();

  /// Runs everything due at `now`. Call after every other call and at next_deadline().
  void advance(TimePoint now);
  /// When advance() is next needed; nullopt: only after an event.
  std::optional<TimePoint> next_deadline() const;

  /// Datagrams due, in order. Each call empties the list.
  std::vector<TopsideDatagram> take_outgoing();
  /// Pings that ended, in order. Each call empties the list.
  std::vector<ReceivedPing> take_pings();

  /// nullopt until the first status of the head.
  const std::optional<HeadInfo>& head() const { return head_; }
  /// All pings asked for by start() are delivered, or stop() was called.
  bool finished() const { return stopped_ || (programme_ && programme_->finished()); }
  const LinkStatistics& statistics() const { return statistics_; }

 private:
  /// What start() asked for.
  struct Programme {
    PingConfig config;
    std::uint64_t wanted = 0;
    std::uint64_t delivered = 0;
    std::uint64_t least_head_us = 0;  ///< a ping transmitted before this answers something older

    bool continuous() const { return config.mode() == RunMode::continuous; }
    bool finished() const { return wanted > 0 && delivered >= wanted; }
  };

  /// A configuration that no ping has answered to its end yet.
  struct Request {
    TimePoint sent{};
    int sends = 0;
    int probes = 0;                ///< head requests since the last send
    bool timed = false;            ///< config_to_ping_ has its sample
    std::optional<TimePoint> due;  ///< next probe or repetition; nullopt while a ping is coming in
  };

  /// The ping that is coming in.
  struct Incoming {
    Incoming(std::uint8_t id, TimePoint now)
        : assembly(id), first_datagram(now), last_arrival(now), progress(now), marked_at(now) {}

    /// Two pings of a head that counts its IDs otherwise than modulo 256 differ in their time.
    bool may_have(const PingHead& head) const {
      return !assembly.head() || assembly.head()->transmit_time_us == head.transmit_time_us;
    }

    PingAssembly assembly;
    TimePoint first_datagram;
    TimePoint last_arrival;  ///< last datagram of it, or last time something was asked
    TimePoint progress;      ///< last datagram of it that brought something new
    bool requested = true;   ///< false: answers no configuration of ours; it is only watched until it ends
    bool pass_over = false;  ///< the head has sent all of it once; from here on it answers requests
    bool has_tail = false;
    bool head_asked = false;
    bool asked_ahead = false;
    int highest = -1;     ///< line of the first pass
    TimePoint marked_at;  ///< when `marked` was the highest line
    int marked = 0;       ///< what is missing below is lost, not late
    int asked_to = 0;     ///< what is missing below has been asked for
    int fruitless = 0;    ///< rounds of requests without an answer
    int lines_repaired = 0;
    RetryCounters retries;
    std::optional<TimePoint> asked;  ///< first request since the last answer
  };

  /// Identity of a ping that has ended, so that its stragglers are known.
  struct Ended {
    std::uint8_t id = 0;
    std::optional<std::uint64_t> transmit_time_us;  ///< nullopt when its head never came
  };

  void on_report(TimePoint now, const Status& status);
  void on_report(TimePoint now, const Acknowledge& acknowledge);
  void on_report(TimePoint now, const Diagnostic& diagnostic);
  void on_report(TimePoint now, const PingHead& head);
  void on_report(TimePoint now, const PingLine& line);
  void on_report(TimePoint now, const PingTail& tail);
  template <class Other>
  void on_report(TimePoint, const Other&) {}  // nothing that a topside needs

  void meet_head(TimePoint now);
  void on_reboot();

  // Configurations.
  void request_ping(TimePoint now);
  void send_config(TimePoint now);
  void on_request_due(TimePoint now);
  void await_next(TimePoint now);
  void stop_when_finished();
  void watch_for_silence(TimePoint now);

  // The ping that is coming in.
  /// Nothing can be asked of a head whose address is not known yet.
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

  TopsideConfig config_;
  std::optional<HeadInfo> head_;
  HeadClock head_clock_;
  bool diagnostic_known_ = false;
  std::optional<TimePoint> stay_alive_due_;

  std::optional<Programme> programme_;
  bool stopped_ = false;
  std::optional<Request> request_;
  std::optional<TimePoint>
      next_request_due_;                  ///< single mode: the next configuration waits for a second ping
  std::optional<TimePoint> last_end_;     ///< continuous mode: of the newest ping
  std::optional<TimePoint> silence_due_;  ///< continuous mode: pings should have come by then

  std::optional<Incoming> incoming_;
  std::optional<Incoming> lingering_;  ///< superseded; takes what is still under way until lingering_due_
  TimePoint lingering_due_{};
  std::deque<Ended> ended_;
  std::optional<std::uint8_t> last_id_;

  ResponseTime config_to_ping_;
  ResponseTime request_to_answer_;

  std::uint64_t next_number_ = 0;
  std::vector<TopsideDatagram> outgoing_;
  std::vector<ReceivedPing> pings_;
  LinkStatistics statistics_;
};

}  // namespace sonard::gemini
