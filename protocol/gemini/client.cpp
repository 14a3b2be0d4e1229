// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/client.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "protocol/gemini/codec.hpp"

namespace sonard::gemini {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr std::uint16_t resent_head = 0x0100;  // bit of PingHead::ping_id (6.3)

constexpr nanoseconds stay_alive_period = seconds{1};

/// Time from a configuration to the first datagram of its ping. The head may be rendering or waiting for its
/// rate limit, so waiting costs less than a second ping.
constexpr ResponseTime::Limits config_limits{seconds{1}, milliseconds{200}, seconds{2}};
constexpr nanoseconds config_patience_most = seconds{2};

/// Time from a retry request to the first resent datagram. In continuous mode a head delays its next ping
/// only while requests arrived within the last 10 ms (7.3). Two datagrams every 2 ms fail to keep this up
/// once in 1e13 times on a link that loses 5 %. On a slow link the answer takes longer than the 10 ms, so the
/// client sends several requests.
constexpr ResponseTime::Limits answer_limits{milliseconds{3}, milliseconds{2}, milliseconds{25}};
constexpr nanoseconds answer_patience_continuous = milliseconds{2};
constexpr nanoseconds answer_patience_most = milliseconds{100};
constexpr int fruitless_rounds_at_full_speed = 4;

/// A line that arrives later than this after a higher one counts as lost. The head answers only after the
/// tail, so an earlier request would gain nothing.
constexpr nanoseconds reorder_patience = milliseconds{1};
/// Silence in the first pass that means its end was lost, in addition to the acoustic time of a burst, for
/// which a head waits before it sends one. A false alarm costs a resent tail. Real clients wait similarly
/// long (7.1, 7.2). Near the end early ones repeat requests after 5 ms, later ones if the last 35 lines come
/// slower than one per millisecond. Before, they give a ping 400 ms.
constexpr nanoseconds stream_patience = milliseconds{8};
constexpr nanoseconds stream_patience_before_the_end = milliseconds{400};
constexpr int last_lines = 35;
constexpr int burst_lines = 32;
/// The tail follows the last line immediately, and the first line follows the head immediately.
constexpr nanoseconds neighbour_patience = milliseconds{2};
/// This close to its end, an incomplete ping gets a precautionary request in continuous mode. Without a
/// recent request the head begins its next ping at once, and the last lines may be lost along with the tail.
constexpr int precaution_lines = 8;
/// Rounds of requests if only the tail is missing, which the image does not need.
constexpr int rounds_for_the_tail_alone = 8;
/// If nothing new arrives for this long, the rest of the ping will not arrive.
constexpr nanoseconds give_up_after = seconds{1};
/// Datagrams in transit at the start of the next ping arrive within this time.
constexpr nanoseconds linger_time = milliseconds{10};
/// An unrequested ping has ended if no datagram of it arrives for this long.
constexpr nanoseconds unrequested_patience = milliseconds{100};

constexpr int copies_of_a_repeated_request = 2;
constexpr int few_lines = 16;  ///< up to this number, second copies of requests cost the link little
constexpr std::size_t most_ranges_a_round = 256;
constexpr int probes_before_config = 3;
constexpr std::size_t ended_kept = 8;
/// If more IDs than this are skipped, it is a jump, not loss.
constexpr int most_missed_at_once = 32;
/// A larger step back of the head's clock is a reboot, not a delayed status.
constexpr std::uint64_t reboot_jump_us = 500'000;

std::uint8_t low_byte(std::uint16_t ping_id) {
  return static_cast<std::uint8_t>(ping_id & 0xFF);
}

bool due_by(const std::optional<TimePoint>& due, TimePoint now) {
  return due && *due <= now;
}

void take_earlier(std::optional<TimePoint>& earliest, const std::optional<TimePoint>& candidate) {
  if (candidate && (!earliest || *candidate < *earliest)) {
    earliest = candidate;
  }
}

/// Without a head, assumes the maximum compression of 4.
/// @param highest highest line number that has arrived, -1 if no line has
nanoseconds stream_quiet(const PingAssembly& ping, int highest) {
  const bool before_the_end = ping.head() && highest < ping.line_count() - last_lines;
  const int native_lines = burst_lines << (ping.head() ? ping.head()->compression_log2() : 4);
  return (before_the_end ? stream_patience_before_the_end : stream_patience) +
         nanoseconds{static_cast<std::int64_t>(native_lines * (1e9 / line_rate_hz))};
}

nanoseconds doubled(nanoseconds patience, int times, nanoseconds most) {
  return std::min(patience * (1 << std::clamp(times, 0, 10)), most);
}

}  // namespace

Client::Client(const ClientConfig& config)
    : config_(config), config_to_ping_(config_limits), request_to_answer_(answer_limits) {}

void Client::on_datagram(TimePoint now, std::span<const std::uint8_t> bytes) {
  ++statistics_.datagrams;
  const auto report = decode_report(bytes);
  if (!report) {
    ++statistics_.bad_datagrams;
    return;
  }
  const std::uint16_t wanted_id = head_ ? head_->status.sonar_id : config_.sonar_id;
  if (wanted_id != 0 && header_of(*report).sonar_id != wanted_id) {
    ++statistics_.other_heads;
    return;
  }
  std::visit([&](const auto& message) { on_report(now, message); }, *report);
}

void Client::start(TimePoint now, const PingConfig& config, std::uint64_t pings) {
  programme_ = Programme{.config = config, .wanted = pings};
  stopped_ = false;
  request_.reset();
  next_request_due_.reset();
  silence_due_.reset();
  lingering_.reset();
  last_id_.reset();
  last_end_.reset();
  if (incoming_) {
    incoming_->requested = false;
  }
  if (head_ && !stay_alive_due_) {
    stay_alive_due_ = now;
  }
  request_ping(now);
}

void Client::stop() {
  if (stopped_) {
    return;
  }
  if (head_ && programme_) {
    send(GoingOffline{});
    send(GoingOffline{});
  }
  stopped_ = true;
  stay_alive_due_.reset();
  request_.reset();
  next_request_due_.reset();
  silence_due_.reset();
  incoming_.reset();
  lingering_.reset();
}

void Client::advance(TimePoint now) {
  if (due_by(stay_alive_due_, now)) {
    send(StatusRequest{});
    stay_alive_due_ = now + stay_alive_period;
  }
  if (lingering_ && lingering_due_ <= now) {
    close_lingering(now);
  }
  if (incoming_ && due(*incoming_) <= now) {
    on_incoming_due(now);
  }
  if (due_by(next_request_due_, now) && !incoming_) {
    next_request_due_.reset();
    request_ping(now);
  }
  if (due_by(silence_due_, now)) {
    silence_due_.reset();
    watch_for_silence(now);
  }
  if (request_ && due_by(request_->due, now)) {
    on_request_due(now);
  }
  stop_when_finished();
}

std::optional<TimePoint> Client::next_deadline() const {
  std::optional<TimePoint> earliest = stay_alive_due_;
  if (lingering_) {
    take_earlier(earliest, lingering_due_);
  }
  if (incoming_) {
    take_earlier(earliest, due(*incoming_));
  } else {
    take_earlier(earliest, next_request_due_);
  }
  take_earlier(earliest, silence_due_);
  if (request_) {
    take_earlier(earliest, request_->due);
  }
  return earliest;
}

std::vector<ClientDatagram> Client::take_outgoing() {
  return std::exchange(outgoing_, {});
}

std::vector<ReceivedPing> Client::take_pings() {
  return std::exchange(pings_, {});
}

// ---------------------------------------------------------------------------------------------------------------
// The head
// ---------------------------------------------------------------------------------------------------------------

void Client::on_report(TimePoint now, const Status& status) {
  const Ipv4 address = config_.head_address != 0 ? config_.head_address : status.alternate_ip;
  if (status.sonar_id < min_sonar_id || status.sonar_id != status.header.sonar_id || address == 0) {
    ++statistics_.bad_datagrams;  // no client could reach such a head (1.2, 1.4)
    return;
  }
  ++statistics_.statuses;
  const bool met_before = head_.has_value();
  const bool rebooted = met_before && status.clock_us + reboot_jump_us < head_->status.clock_us;
  head_ = HeadInfo{status, address};
  if (rebooted) {
    on_reboot();
  }
  head_clock_.observe(now, status.clock_us);
  if (stopped_) {
    return;
  }
  if (!met_before || rebooted) {
    meet_head(now);
  }
  if (!diagnostic_known_) {
    send(DiagnosticRequest{});
  }
}

void Client::meet_head(TimePoint now) {
  NetworkConfig network;  // as later clients send it at first contact
  network.serial_routing = 0x0100;
  network.extension = 10'000;
  send(network);
  stay_alive_due_ = now;
  if (programme_ && !programme_->finished()) {
    request_ping(now);
  }
}

void Client::on_reboot() {
  ++statistics_.reboots;
  for (auto* ping : {&incoming_, &lingering_}) {
    statistics_.pings_abandoned += *ping && (*ping)->requested ? 1 : 0;
    ping->reset();
  }
  head_clock_.forget();
  diagnostic_known_ = false;
  ended_.clear();
  last_id_.reset();
  next_request_due_.reset();
  silence_due_.reset();
}

void Client::on_report(TimePoint now, const Acknowledge& acknowledge) {
  ++statistics_.acknowledges;
  head_clock_.observe(now, acknowledge.reply_us);
}

void Client::on_report(TimePoint, const Diagnostic&) {
  diagnostic_known_ = true;
}

// ---------------------------------------------------------------------------------------------------------------
// Configurations
// ---------------------------------------------------------------------------------------------------------------

void Client::request_ping(TimePoint now) {
  request_.emplace(Request{});
  if (head_) {
    send_config(now);
  }
}

void Client::send_config(TimePoint now) {
  if (++request_->sends == 1) {
    programme_->least_head_us = head_clock_.at_least_us(now);
  } else {
    ++statistics_.configs_repeated;
  }
  ++statistics_.configs_sent;
  send(programme_->config);
  request_->sent = now;
  request_->probes = 0;
  request_->due = now + doubled(config_to_ping_.patience(), request_->sends - 1, config_patience_most);
}

/// No ping came: either the configuration or the whole ping was lost. A second configuration is harmless only
/// in the first case, so request the head of the last ping first. A new ping can be repaired. If the ping is
/// old or there is no answer, send the configuration again.
void Client::on_request_due(TimePoint now) {
  if (request_->probes == probes_before_config) {
    send_config(now);
    return;
  }
  ++request_->probes;
  ask(nullptr, RetryKind::head, {0, 1}, copies_of_a_repeated_request);
  request_->due = now + request_to_answer_.patience();
}

void Client::watch_for_silence(TimePoint now) {
  if (request_ || incoming_) {
    return;
  }
  request_.emplace(Request{});
  request_->sends = 1;  // counts the programme's first configuration, so that the next one is a repetition
  request_->due = now;
}

void Client::await_next(TimePoint now) {
  const bool repeated = request_ && request_->sends > 1;
  request_.reset();
  if (programme_->finished()) {
    return;
  }
  if (programme_->continuous()) {
    // A head that renders slowly exceeds the configured interval.
    const nanoseconds interval = std::chrono::microseconds{programme_->config.interping_us};
    silence_due_ = now + 2 * std::max(interval, now - last_end_.value_or(now)) + seconds{1};
    last_end_ = now;
  } else if (repeated) {
    // The first configuration may have arrived after all, so a second ping may be arriving. A third
    // configuration now would cut short its repair, again and again.
    next_request_due_ = now + config_to_ping_.patience();
  } else {
    request_ping(now);
  }
}

// ---------------------------------------------------------------------------------------------------------------
// The ping that is coming in
// ---------------------------------------------------------------------------------------------------------------

void Client::on_report(TimePoint now, const PingHead& head) {
  if (!takes_pings()) {
    return;
  }
  if (!is_receivable(head)) {
    ++statistics_.bad_datagrams;
    return;
  }
  const std::uint8_t id = low_byte(head.ping_id);
  const Ended* ended = find_ended(id);
  if (ended != nullptr && ended->transmit_time_us.value_or(head.transmit_time_us) == head.transmit_time_us) {
    if (request_ && request_->due && request_->probes > 0) {
      send_config(now);  // the head still holds the previous ping, so the requested one has not begun
    }
    return;
  }
  Incoming* ping = find_incoming(id);
  if (ping == nullptr || !ping->may_have(head)) {
    ping = &begin(now, id);
  }
  ping->last_arrival = now;
  if ((head.ping_id & resent_head) != 0) {
    on_answer(now, *ping);
  }
  if (!ping->assembly.head()) {
    adopt_head(now, *ping, head);
  }
  settle(now);
}

void Client::on_report(TimePoint now, const PingLine& line) {
  if (!takes_pings()) {
    return;
  }
  Incoming* ping = incoming_for(now, line.ping_id);
  if (ping == nullptr) {
    ++statistics_.lines_duplicate;
    return;
  }
  ping->last_arrival = now;
  const auto added = ping->assembly.add_line(line);
  if (added == PingAssembly::Added::unusable) {
    ++statistics_.bad_datagrams;
    return;
  }
  if (added == PingAssembly::Added::duplicate) {
    ++statistics_.lines_duplicate;
  } else {
    ping->progress = now;
    ++statistics_.lines_received;
    statistics_.lines_repaired += line.resent() ? 1 : 0;
    ping->lines_repaired += line.resent() ? 1 : 0;
  }
  if (line.resent()) {
    on_answer(now, *ping);
  } else if (!ping->pass_over) {
    follow_first_pass(now, *ping, line.line_number());
  }
  settle(now);
}

void Client::on_report(TimePoint now, const PingTail& tail) {
  if (!takes_pings()) {
    return;
  }
  Incoming* ping = incoming_for(now, tail.ping_id);
  if (ping == nullptr) {
    return;
  }
  ping->last_arrival = now;
  if (!ping->has_tail) {
    ping->has_tail = true;
    ping->progress = now;
  }
  if (tail.resent()) {
    on_answer(now, *ping);
  } else {
    end_pass(*ping);
  }
  settle(now);
}

Client::Incoming* Client::find_incoming(std::uint8_t id) {
  for (auto* ping : {&incoming_, &lingering_}) {
    if (*ping && (*ping)->assembly.id() == id) {
      return &**ping;
    }
  }
  return nullptr;
}

Client::Incoming* Client::incoming_for(TimePoint now, std::uint8_t id) {
  Incoming* ping = find_incoming(id);
  if (ping != nullptr) {
    return ping;
  }
  return find_ended(id) != nullptr ? nullptr : &begin(now, id);
}

const Client::Ended* Client::find_ended(std::uint8_t id) const {
  const auto found =
      std::find_if(ended_.rbegin(), ended_.rend(), [id](const Ended& ping) { return ping.id == id; });
  return found == ended_.rend() ? nullptr : &*found;
}

Client::Incoming& Client::begin(TimePoint now, std::uint8_t id) {
  if (incoming_) {
    supersede(now);
  }
  if (programme_->continuous() && last_id_ && *last_id_ != id) {
    const int skipped = static_cast<std::uint8_t>(id - *last_id_ - 1);
    statistics_.pings_missed += static_cast<std::uint64_t>(skipped <= most_missed_at_once ? skipped : 0);
  }
  last_id_ = id;
  incoming_.emplace(id, now);
  incoming_->requested = !programme_->finished() && (programme_->continuous() || request_);
  if (request_ && incoming_->requested) {
    request_->due.reset();
  }
  return *incoming_;
}

void Client::adopt_head(TimePoint now, Incoming& ping, const PingHead& head) {
  ping.assembly.set_head(head);
  ping.progress = now;
  if (head.transmit_time_us < programme_->least_head_us) {
    ping.requested = false;  // transmitted before our configuration; the request waits for its end
    return;
  }
  if (request_ && request_->sends == 1 && request_->probes == 0 && !request_->timed) {
    config_to_ping_.sample(ping.first_datagram - request_->sent);
    request_->timed = true;
  }
  if (ping.pass_over) {
    ask_unasked(ping, ping.assembly.line_count());
  }
}

/// A head serves requests only after the tail, so any resent datagram ends the first pass.
void Client::on_answer(TimePoint now, Incoming& ping) {
  if (ping.asked) {
    request_to_answer_.sample(now - *ping.asked);
    ping.asked.reset();
  }
  ping.fruitless = 0;
  end_pass(ping);
}

void Client::end_pass(Incoming& ping) {
  if (ping.pass_over) {
    return;
  }
  ping.pass_over = true;
  if (!ping.requested) {
    return;
  }
  if (ping.assembly.head()) {
    ask_unasked(ping, ping.assembly.line_count());
  } else if (!ping.head_asked) {
    ask(&ping, RetryKind::head, {0, 1}, 1);
  }
}

/// Handles line `number` of the first pass.
void Client::follow_first_pass(TimePoint now, Incoming& ping, int number) {
  ping.highest = std::max(ping.highest, number);
  if (!ping.requested) {
    return;
  }
  if (now - ping.marked_at >= reorder_patience) {
    ask_unasked(ping, ping.marked);
    ping.marked_at = now;
    ping.marked = ping.highest;
  }
  const bool damaged = ping.assembly.lines_received() <= ping.highest;
  if (programme_->continuous() && damaged && !ping.asked_ahead && ping.assembly.head() &&
      ping.highest >= ping.assembly.line_count() - precaution_lines) {
    ping.asked_ahead = true;
    ask(&ping, RetryKind::tail, {0, 1}, copies_of_a_repeated_request);
  }
}

/// Requests the lines below `end` that are missing and have not been requested.
void Client::ask_unasked(Incoming& ping, int end) {
  for (const LineRange& range : ping.assembly.missing(ping.asked_to, end)) {
    ask(&ping, RetryKind::lines, range, 1);
  }
  ping.asked_to = std::max(ping.asked_to, end);
}

/// One round: requests everything that is missing, the head first.
void Client::ask_again(TimePoint now, Incoming& ping) {
  ++ping.fruitless;
  ping.last_arrival = now;
  if (!ping.assembly.head()) {
    ask(&ping, RetryKind::head, {0, 1}, copies_of_a_repeated_request);
  }
  if (ping.pass_over) {
    if (!ping.asked) {
      ping.asked = now;
    }
    const int missing = ping.assembly.line_count() - ping.assembly.lines_received();
    auto ranges = ping.assembly.missing(0, ping.assembly.line_count());
    ranges.resize(std::min(ranges.size(), most_ranges_a_round));
    for (const LineRange& range : ranges) {
      ask(&ping, RetryKind::lines, range, missing <= few_lines ? copies_of_a_repeated_request : 1);
    }
  }
  if (!ping.has_tail) {
    ask(&ping, RetryKind::tail, {0, 1}, copies_of_a_repeated_request);
  }
}

TimePoint Client::due(const Incoming& ping) const {
  if (!ping.requested) {
    return ping.last_arrival + unrequested_patience;
  }
  const int slower = ping.fruitless - fruitless_rounds_at_full_speed;
  if (ping.pass_over) {
    const auto patience = request_to_answer_.patience();
    return ping.last_arrival +
           doubled(programme_->continuous() ? std::min(patience, answer_patience_continuous) : patience,
                   slower, answer_patience_most);
  }
  if (ping.assembly.is_complete()) {
    return ping.last_arrival + doubled(neighbour_patience, slower, answer_patience_most);
  }
  const nanoseconds patience = stream_quiet(ping.assembly, ping.highest);
  const TimePoint quiet =
      ping.last_arrival + doubled(patience, slower, std::max(patience, answer_patience_most));
  const bool headless = !ping.assembly.head() && !ping.head_asked;
  return headless ? std::min(quiet, ping.first_datagram + neighbour_patience) : quiet;
}

void Client::on_incoming_due(TimePoint now) {
  Incoming& ping = *incoming_;
  const bool only_tail_lacks = ping.assembly.is_complete() && ping.fruitless >= rounds_for_the_tail_alone;
  if (!ping.requested || only_tail_lacks || now - ping.progress >= give_up_after) {
    finish(now);
  } else if (!ping.assembly.head() && !ping.head_asked) {
    ask(&ping, RetryKind::head, {0, 1}, 1);
  } else {
    ask_again(now, ping);
  }
}

void Client::settle(TimePoint now) {
  if (lingering_ && lingering_->assembly.is_complete()) {
    close_lingering(now);
  }
  const bool ends = incoming_ && incoming_->has_tail;
  if (ends && (!incoming_->requested || incoming_->assembly.is_complete())) {
    finish(now);
  }
  stop_when_finished();
}

/// Stops a finished continuous programme; in single mode the head stops by itself.
void Client::stop_when_finished() {
  if (!stopped_ && programme_ && programme_->continuous() && programme_->finished()) {
    stop();
  }
}

/// Handles a new ping that begins before the end of the old one, which the head has dropped (7.3).
void Client::supersede(TimePoint now) {
  Incoming& ping = *incoming_;
  if (ping.requested && ping.assembly.is_complete()) {
    finish(now);  // only the tail was missing
    return;
  }
  if (!ping.requested) {
    ++statistics_.pings_unrequested;
  } else if (!programme_->continuous()) {
    ++statistics_.pings_abandoned;  // the new one answers the configuration
  } else if (!ping.assembly.head()) {
    ++statistics_.pings_missed;
  } else {
    close_lingering(now);
    lingering_ = std::move(incoming_);
    lingering_->pass_over = true;  // the head cannot resend parts of it any more
    lingering_due_ = now + linger_time;
    incoming_.reset();
    return;
  }
  note_end(ping);
  incoming_.reset();
}

void Client::finish(TimePoint now) {
  close_lingering(now);
  Incoming ping = std::move(*incoming_);
  incoming_.reset();
  if (!ping.requested) {
    note_end(ping);
    ++statistics_.pings_unrequested;
    if (next_request_due_) {
      next_request_due_ = now;  // this was the second ping that the next configuration waited for
    }
    if (request_ && request_->sends > 0) {
      request_->due = now + config_to_ping_.patience();
    }
    return;
  }
  if (!ping.assembly.head()) {
    ++statistics_.pings_abandoned;
    if (!request_) {
      request_.emplace(Request{});
    }
    // The configuration is still unanswered. If a late head answers it, the whole ping can be repaired.
    request_->due = now;
    return;
  }
  note_end(ping);
  deliver(now, std::move(ping));
  await_next(now);
}

void Client::close_lingering(TimePoint now) {
  if (!lingering_) {
    return;
  }
  Incoming ping = std::move(*lingering_);
  lingering_.reset();
  note_end(ping);
  deliver(now, std::move(ping));
}

void Client::deliver(TimePoint now, Incoming ping) {
  if (programme_->finished()) {
    ++statistics_.pings_unrequested;
    return;
  }
  ReceivedPing received;
  received.number = next_number_++;
  received.head = *ping.assembly.head();
  received.lines = ping.assembly.line_count();
  received.lines_lost = received.lines - ping.assembly.lines_received();
  received.lines_repaired = ping.lines_repaired;
  received.retries = ping.retries;
  received.first_datagram = ping.first_datagram;
  received.finished = now;
  received.samples = ping.assembly.take_samples();
  ++(received.complete() ? statistics_.pings_complete : statistics_.pings_incomplete);
  statistics_.lines_missing += static_cast<std::uint64_t>(received.lines_lost);
  ++programme_->delivered;
  pings_.push_back(std::move(received));
}

void Client::note_end(const Incoming& ping) {
  const auto& head = ping.assembly.head();
  ended_.push_back({ping.assembly.id(), head ? std::optional{head->transmit_time_us} : std::nullopt});
  if (ended_.size() > ended_kept) {
    ended_.pop_front();
  }
}

// ---------------------------------------------------------------------------------------------------------------
// Sending
// ---------------------------------------------------------------------------------------------------------------

void Client::ask(Incoming* ping, RetryKind kind, LineRange range, int copies) {
  RetryRequest request;
  request.kind = kind;
  request.first_line = static_cast<std::uint16_t>(range.first);
  request.line_count = static_cast<std::uint16_t>(range.count);
  for (int copy = 0; copy < copies; ++copy) {
    send(request);
  }
  const auto count = [&](RetryCounters& counters) {
    auto& counter = kind == RetryKind::head    ? counters.head
                    : kind == RetryKind::lines ? counters.lines
                                               : counters.tail;
    counter += static_cast<std::uint64_t>(copies);
  };
  count(statistics_.retries);
  if (ping != nullptr) {
    count(ping->retries);
    ping->head_asked = ping->head_asked || kind == RetryKind::head;
  }
}

template <class Message>
void Client::send(Message message) {
  message.header.sonar_id = head_->status.sonar_id;
  message.header.version = head_->status.header.version;
  outgoing_.push_back({head_->address, encode(Command{std::move(message)})});
}

}  // namespace sonard::gemini
