// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/client.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <variant>

#include "protocol/gemini/codec.hpp"

namespace sonard::gemini {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr nanoseconds stay_alive_period = seconds{1};
constexpr nanoseconds config_patience_most = seconds{2};
constexpr int probes_before_config = 3;
constexpr int copies_of_a_probe = 2;
/// Datagrams in transit at the start of the next ping arrive within this time.
constexpr nanoseconds linger_time = milliseconds{10};
constexpr std::size_t ended_kept = 8;
/// If more IDs than this are skipped, it is a jump, not loss.
constexpr int most_missed_at_once = 32;
/// A larger step back of the head's clock is a reboot, not a delayed status.
constexpr std::uint64_t reboot_jump_us = 500'000;

bool due_by(const std::optional<TimePoint>& due, TimePoint now) {
  return due && *due <= now;
}

}  // namespace

void Client::on_datagram(TimePoint now, std::span<const std::uint8_t> bytes) {
  ++statistics_.datagrams;
  const auto report = decode_report(bytes);
  if (!report) {
    ++statistics_.bad_datagrams;
    return;
  }
  const std::uint16_t wanted_id = head_ ? head_->status.sonar_id : config_.sonar_id;
  if (wanted_id == 0 || header_of(*report).sonar_id == wanted_id) {
    std::visit([&](const auto& message) { on_report(now, message); }, *report);
  } else if (const auto* const status = std::get_if<Status>(&*report)) {
    other_heads_[status->sonar_id] = status->alternate_ip;
  }
}

void Client::start(TimePoint now, const PingConfig& config, std::uint64_t pings) {
  programme_ = Programme{.config = config, .wanted = pings};
  stopped_ = false;
  forget_requests();
  lingering_.reset();
  last_id_.reset();
  last_end_.reset();
  if (incoming_) {
    incoming_->disown();
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
  forget_requests();
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
  if (incoming_ && incoming_->due(request_to_answer_) <= now) {
    if (incoming_->is_over(now)) {
      finish(now);
    } else {
      incoming_->ask_again(now);
      send_requests(*incoming_);
    }
  }
  if (due_by(next_request_due_, now) && !incoming_) {
    next_request_due_.reset();
    request_ping(now);
  }
  if (due_by(silence_due_, now)) {
    silence_due_.reset();
    if (!request_ && !incoming_) {
      request_ = Request{.sends = 1, .due = now};  // the programme's first configuration counts as sent
    }
  }
  if (request_ && due_by(request_->due, now)) {
    on_request_due(now);
  }
  stop_when_finished();
}

std::optional<TimePoint> Client::next_deadline() const {
  std::optional<TimePoint> earliest = stay_alive_due_;
  const auto consider = [&earliest](const std::optional<TimePoint>& due) {
    earliest = due ? std::min(*due, earliest.value_or(*due)) : earliest;
  };
  if (lingering_) {
    consider(lingering_due_);
  }
  consider(incoming_ ? incoming_->due(request_to_answer_) : next_request_due_);
  consider(silence_due_);
  if (request_) {
    consider(request_->due);
  }
  return earliest;
}

// ---- The head

void Client::on_report(TimePoint now, const Status& status) {
  const Ipv4 address = config_.head_address != 0 ? config_.head_address : status.alternate_ip;
  if (status.sonar_id < min_sonar_id || status.sonar_id != status.header.sonar_id || address == 0) {
    ++statistics_.bad_datagrams;  // no client could reach such a head (1.2, 1.4)
    other_heads_[status.sonar_id] = status.alternate_ip;
    return;
  }
  const bool rebooted = head_ && status.clock_us + reboot_jump_us < head_->status.clock_us;
  const bool is_new = !head_ || rebooted;
  head_ = HeadInfo{status, address};
  if (rebooted) {
    on_reboot();
  }
  head_clock_.observe(now, status.clock_us);
  if (stopped_) {
    return;
  }
  if (is_new) {
    NetworkConfig network;  // as later clients send it at first contact
    network.serial_routing = 0x0100;
    network.extension = 10'000;
    send(network);
    stay_alive_due_ = now;
    if (programme_ && !programme_->finished()) {
      request_ping(now);
    }
  }
  if (!diagnostic_known_) {
    send(DiagnosticRequest{});
  }
}

void Client::on_reboot() {
  ++statistics_.reboots;
  for (auto* ping : {&incoming_, &lingering_}) {
    statistics_.pings_abandoned += *ping && (*ping)->requested() ? 1 : 0;
    ping->reset();
  }
  head_clock_.forget();
  diagnostic_known_ = false;
  ended_.clear();
  last_id_.reset();
  forget_requests();
}

void Client::on_report(TimePoint now, const Acknowledge& acknowledge) {
  head_clock_.observe(now, acknowledge.reply_us);
}

void Client::on_report(TimePoint, const Diagnostic&) {
  diagnostic_known_ = true;
}

// ---- Configurations

void Client::forget_requests() {
  request_.reset();
  next_request_due_.reset();
  silence_due_.reset();
}

void Client::request_ping(TimePoint now) {
  request_ = Request{};
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
  for (int copy = 0; copy < copies_of_a_probe; ++copy) {
    send(RetryRequest{});
  }
  request_->due = now + request_to_answer_.patience();
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

// ---- Pings

void Client::on_report(TimePoint now, const PingHead& head) {
  if (!takes_pings()) {
    return;
  }
  if (!is_receivable(head)) {
    ++statistics_.bad_datagrams;
    return;
  }
  const auto id = static_cast<std::uint8_t>(head.ping_id & 0xFF);
  const Ended* ended = find_ended(id);
  if (ended != nullptr && ended->transmit_time_us.value_or(head.transmit_time_us) == head.transmit_time_us) {
    if (request_ && request_->due && request_->probes > 0) {
      send_config(now);  // the head still holds the previous ping, so the requested one has not begun
    }
    return;
  }
  ArrivingPing* ping = arriving(id);
  if (ping == nullptr || !ping->may_have(head)) {
    ping = &begin(now, id);
  }
  if (!ping->assembly().head()) {
    if (head.transmit_time_us < programme_->least_head_us) {
      ping->disown();  // transmitted before our configuration; the request waits for its end
    } else if (request_ && request_->sends == 1 && request_->probes == 0 &&
               !std::exchange(request_->timed, true)) {
      config_to_ping_.sample(ping->first_datagram() - request_->sent);
    }
  }
  ping->on_head(now, head, request_to_answer_);
  settle(now, *ping);
}

void Client::on_report(TimePoint now, const PingLine& line) {
  if (!takes_pings()) {
    return;
  }
  ArrivingPing* const ping = arriving_or_new(now, line.ping_id);
  const auto added =
      ping != nullptr ? ping->on_line(now, line, request_to_answer_) : PingAssembly::Added::duplicate;
  statistics_.bad_datagrams += added == PingAssembly::Added::unusable ? 1 : 0;
  statistics_.lines_duplicate += added == PingAssembly::Added::duplicate ? 1 : 0;
  statistics_.lines_repaired += added == PingAssembly::Added::fresh && line.resent() ? 1 : 0;
  if (ping != nullptr) {
    settle(now, *ping);
  }
}

void Client::on_report(TimePoint now, const PingTail& tail) {
  ArrivingPing* const ping = takes_pings() ? arriving_or_new(now, tail.ping_id) : nullptr;
  if (ping != nullptr) {
    ping->on_tail(now, tail, request_to_answer_);
    settle(now, *ping);
  }
}

ArrivingPing* Client::arriving(std::uint8_t id) {
  for (auto* ping : {&incoming_, &lingering_}) {
    if (*ping && (*ping)->assembly().id() == id) {
      return &**ping;
    }
  }
  return nullptr;
}

/// Null if the ping has ended.
ArrivingPing* Client::arriving_or_new(TimePoint now, std::uint8_t id) {
  ArrivingPing* const ping = arriving(id);
  return ping != nullptr || find_ended(id) != nullptr ? ping : &begin(now, id);
}

const Client::Ended* Client::find_ended(std::uint8_t id) const {
  const auto found =
      std::find_if(ended_.rbegin(), ended_.rend(), [id](const Ended& ping) { return ping.id == id; });
  return found == ended_.rend() ? nullptr : &*found;
}

ArrivingPing& Client::begin(TimePoint now, std::uint8_t id) {
  if (incoming_) {
    supersede(now);
  }
  if (programme_->continuous() && last_id_ && *last_id_ != id) {
    const int skipped = static_cast<std::uint8_t>(id - *last_id_ - 1);
    statistics_.pings_missed += static_cast<std::uint64_t>(skipped <= most_missed_at_once ? skipped : 0);
  }
  last_id_ = id;
  const bool requested = !programme_->finished() && (programme_->continuous() || request_);
  incoming_.emplace(id, now, programme_->continuous(), requested);
  if (request_ && requested) {
    request_->due.reset();
  }
  return *incoming_;
}

/// Handles a new ping that begins before the end of the old one, which the head has dropped (7.3).
void Client::supersede(TimePoint now) {
  if (incoming_->requested() && incoming_->assembly().is_complete()) {
    finish(now);  // only the tail was missing
    return;
  }
  if (!incoming_->requested()) {
    ++statistics_.pings_unrequested;
  } else if (!programme_->continuous()) {
    ++statistics_.pings_abandoned;  // the new one answers the configuration
  } else if (!incoming_->assembly().head()) {
    ++statistics_.pings_missed;
  } else {
    close_lingering(now);
    lingering_ = std::exchange(incoming_, std::nullopt);
    lingering_->superseded();
    lingering_due_ = now + linger_time;
    return;
  }
  note_end(*incoming_);
  incoming_.reset();
}

/// Sends what `ping` requests, and ends the pings that have all their parts.
void Client::settle(TimePoint now, ArrivingPing& ping) {
  send_requests(ping);
  if (lingering_ && lingering_->assembly().is_complete()) {
    close_lingering(now);
  }
  if (incoming_ && incoming_->has_tail() &&
      (!incoming_->requested() || incoming_->assembly().is_complete())) {
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

void Client::finish(TimePoint now) {
  close_lingering(now);
  ArrivingPing ping = *std::exchange(incoming_, std::nullopt);
  if (!ping.requested()) {
    note_end(ping);
    ++statistics_.pings_unrequested;
    if (next_request_due_) {
      next_request_due_ = now;  // this was the second ping that the next configuration waited for
    }
    if (request_ && request_->sends > 0) {
      request_->due = now + config_to_ping_.patience();
    }
  } else if (!ping.assembly().head()) {
    ++statistics_.pings_abandoned;
    // The configuration is still unanswered. If a late head answers it, the whole ping can be repaired.
    if (!request_) {
      request_ = Request{};
    }
    request_->due = now;
  } else {
    note_end(ping);
    deliver(now, std::move(ping));
    await_next(now);
  }
}

void Client::close_lingering(TimePoint now) {
  if (auto ping = std::exchange(lingering_, std::nullopt)) {
    note_end(*ping);
    deliver(now, std::move(*ping));
  }
}

void Client::deliver(TimePoint now, ArrivingPing ping) {
  if (programme_->finished()) {
    ++statistics_.pings_unrequested;
    return;
  }
  PingAssembly& parts = ping.assembly();
  const int lost = parts.line_count() - parts.lines_received();
  ++(lost == 0 ? statistics_.pings_complete : statistics_.pings_incomplete);
  statistics_.lines_missing += static_cast<std::uint64_t>(lost);
  ++programme_->delivered;
  pings_.push_back({.number = next_number_++,
                    .head = *parts.head(),
                    .samples = parts.take_samples(),
                    .lines = parts.line_count(),
                    .lines_lost = lost,
                    .lines_repaired = ping.lines_repaired(),
                    .retries = ping.retries(),
                    .first_datagram = ping.first_datagram(),
                    .finished = now});
}

void Client::note_end(const ArrivingPing& ping) {
  const auto& head = ping.assembly().head();
  ended_.push_back({ping.assembly().id(), head ? std::optional{head->transmit_time_us} : std::nullopt});
  if (ended_.size() > ended_kept) {
    ended_.pop_front();
  }
}

// ---- Sending

void Client::send_requests(ArrivingPing& ping) {
  for (const RetryRequest& request : ping.take_requests()) {
    send(request);
  }
}

void Client::send(const RetryRequest& request) {
  statistics_.retries.count(request.kind);
  send<RetryRequest>(request);
}

template <class Message>
void Client::send(Message message) {
  message.header.sonar_id = head_->status.sonar_id;
  message.header.version = head_->status.header.version;
  outgoing_.push_back({head_->address, encode(Command{std::move(message)})});
}

}  // namespace sonard::gemini
