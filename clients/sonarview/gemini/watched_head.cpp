// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/watched_head.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/address_v4.hpp>
#include <chrono>
#include <cstdio>
#include <utility>
#include <variant>
#include <vector>

#include "clients/sonarview/gemini/sockets.hpp"
#include "common/text/printable.hpp"
#include "protocol/common/endpoint.hpp"
#include "protocol/gemini/codec.hpp"

namespace sonard::client {
namespace {

using boost::system::error_code;

constexpr std::chrono::nanoseconds progress_period = std::chrono::seconds{1};

gemini::ClientConfig client_of(const GeminiOptions& options, std::uint16_t sonar_id) {
  gemini::ClientConfig config = options.client;
  config.sonar_id = sonar_id;
  return config;
}

}  // namespace

WatchedHead::WatchedHead(const GeminiOptions& options, std::size_t number,
                         boost::asio::ip::udp::socket& commands)
    : options_(options),
      sonar_id_(options.sonar_ids[number]),
      says_(options.sonar_ids.size() > 1 ? fmt::format("sonarview: {}: ", sonar_id_) : "sonarview: "),
      commands_(commands),
      client_(client_of(options, sonar_id_)),
      drop_rx_(options.drop_rx, options.seed, 2 * number),
      drop_tx_(options.drop_tx, options.seed, 2 * number + 1),
      pictures_({.radius_px = options.run.radius_px}, options.settings.sound_speed_mps) {
  if (!options_.run.out.empty()) {
    writer_.emplace(options.sonar_ids.size() > 1 ? options_.run.out / fmt::format("{}", sonar_id_)
                                                 : options_.run.out);
  }
}

void WatchedHead::start(TimePoint at) {
  started_ = at;
  if (!options_.run.quiet) {
    fmt::print(stderr, "{}waiting up to {:.1f} s for the status packet of {} on UDP port {}\n", says_,
               std::chrono::duration<double>(options_.run.wait).count(),
               sonar_id_ != 0 ? fmt::format("head {}", sonar_id_) : "a head", gemini::client_port);
  }
  client_.start(at, make_ping_config(options_.settings), options_.run.pings);
}

void WatchedHead::on_datagram(TimePoint at, std::span<const std::uint8_t> datagram) {
  if (!ended_ && !drop_rx_.drop()) {
    client_.on_datagram(at, datagram);
    note_other_head(datagram);
  }
}

/// Records statuses of other heads until the wanted head is found.
void WatchedHead::note_other_head(std::span<const std::uint8_t> datagram) {
  if (head_met_ || client_.head()) {
    return;
  }
  const auto report = gemini::decode_report(datagram);
  if (const auto* const status = report ? std::get_if<gemini::Status>(&*report) : nullptr) {
    others_[status->sonar_id] = status->alternate_ip;
  }
}

/// What to do if the wanted head sent no status.
std::string WatchedHead::advice() const {
  if (others_.empty()) {
    return "check that sonard runs, that it sends its status to this address or broadcasts it on this "
           "network, and that no firewall blocks UDP";
  }
  std::vector<std::string> received;
  for (const auto& [id, address] : others_) {
    received.push_back(fmt::format("{} at {}", id, address_text(address)));
  }
  return fmt::format("only head {} sent a status (to view one, use --sonar-id {})",
                     fmt::join(received, ", head "), others_.begin()->first);
}

void WatchedHead::advance(TimePoint at) {
  if (ended_) {
    return;
  }
  client_.advance(at);
  send_commands();
  for (auto& ping : client_.take_pings()) {
    take_ping(std::move(ping));
  }
  if (client_.head() && !head_met_) {
    head_met_ = last_ping_at_ = at;
    progress_due_ = at + progress_period;
    greet_head();
  }
  if (head_met_ && at >= progress_due_) {
    show_progress(at);
    refresh_picture();
  }
  check_limits(at);
}

void WatchedHead::send_commands() {
  for (const auto& datagram : client_.take_outgoing()) {
    if (drop_tx_.drop()) {
      continue;
    }
    error_code error;
    commands_.send_to(boost::asio::buffer(datagram.bytes),
                      {boost::asio::ip::address_v4(datagram.to), gemini::head_port}, 0, error);
    if (error && !std::exchange(send_failed_, true)) {
      fmt::print(stderr, "{}cannot send to {}:{}: {}\n", says_, address_text(datagram.to), gemini::head_port,
                 error.message());
    }
  }
}

void WatchedHead::take_ping(gemini::ReceivedPing ping) {
  last_ping_at_ = ping.finished;
  rate_.add(ping.finished);
  if (options_.run.log_pings) {
    fmt::print("{}\n", ping_line(ping, client_.head()->status.sonar_id));
    std::fflush(stdout);
  }
  if (!writer_) {
    return;
  }
  if (options_.run.every > 0 && ping.number % options_.run.every == 0) {
    writer_->write(pictures_.of(ping, fmt::format("{:06}", ping.number)));
  }
  last_ping_ = std::move(ping);
  last_ping_shown_ = false;
}

/// Shows the newest ping while the program runs.
void WatchedHead::refresh_picture() {
  if (writer_ && last_ping_ && !std::exchange(last_ping_shown_, true)) {
    writer_->refresh(pictures_.of(*last_ping_, "last"));
  }
}

void WatchedHead::greet_head() {
  const auto& head = *client_.head();
  const gemini::Status& status = head.status;
  if (!options_.run.quiet) {
    fmt::print(stderr, "{}head {} at {}, netmask {}, firmware {:#06x}\n", says_, status.sonar_id,
               address_text(head.address), address_text(status.subnet_mask), status.firmware_version);
  }
  const auto own_mask = interface_netmask(options_.client_address);
  const bool same_network = ((head.address ^ options_.client_address) & status.subnet_mask) == 0;
  if (!same_network || (own_mask && *own_mask != status.subnet_mask)) {
    fmt::print(
        stderr,
        "{}warning: {} with netmask {} and {} with netmask {} are not on one network; later libraries of "
        "the vendor would send nothing\n",
        says_, address_text(head.address), address_text(status.subnet_mask),
        address_text(options_.client_address), own_mask ? address_text(*own_mask) : "unknown");
  }
}

void WatchedHead::show_progress(TimePoint at) {
  progress_due_ = at + progress_period;
  const auto& statistics = client_.statistics();
  const std::uint64_t pings = statistics.pings_complete + statistics.pings_incomplete;
  if (!options_.run.quiet) {
    fmt::print(stderr, "{}{} pings, {} in the last second; {} lines repaired, {} missing\n", says_, pings,
               pings - pings_at_progress_, statistics.lines_repaired, statistics.lines_missing);
  }
  pings_at_progress_ = pings;
}

void WatchedHead::check_limits(TimePoint at) {
  const bool out_of_time =
      head_met_ && options_.run.duration.count() > 0 && at - *head_met_ >= options_.run.duration;
  if (client_.finished() || out_of_time) {
    end();
  } else if (!head_met_ && at - started_ >= options_.run.wait) {
    fail(ExitStatus::no_head,
         fmt::format("no status{} on port {} within {:.1f} s: {}",
                     sonar_id_ != 0 ? fmt::format(" of head {}", sonar_id_) : "", gemini::client_port,
                     std::chrono::duration<double>(options_.run.wait).count(), advice()));
  } else if (head_met_ && options_.run.ping_wait.count() > 0 &&
             at - last_ping_at_ >= options_.run.ping_wait) {
    fail(ExitStatus::incomplete, no_ping_text());
  }
}

std::string WatchedHead::no_ping_text() const {
  const gemini::HeadInfo& head = *client_.head();
  const std::string own = address_text(head.status.alternate_ip);
  return fmt::format(
      "the head sends its status, but no ping for {:.1f} s: check that it can be reached at {}:{} from {}, "
      "and that it has a pose{}",
      std::chrono::duration<double>(options_.run.ping_wait).count(), address_text(head.address),
      gemini::head_port, address_text(options_.client_address),
      head.address == head.status.alternate_ip
          ? ""
          : fmt::format(". Its status gives the address {} (to use it, omit --head)", own));
}

void WatchedHead::fail(ExitStatus status, const std::string& why) {
  fmt::print(stderr, "{}{}\n", says_, printable(why));
  failure_ = status;
  end();
}

void WatchedHead::end() {
  if (!std::exchange(ended_, true)) {
    client_.stop();
    send_commands();
  }
}

std::optional<Ipv4> WatchedHead::address() const {
  return client_.head() ? std::optional(client_.head()->address) : std::nullopt;
}

TimePoint WatchedHead::next_wake(TimePoint at) const {
  TimePoint wake = client_.next_deadline().value_or(TimePoint::max());
  if (!head_met_) {
    return std::min(wake, started_ + options_.run.wait);
  }
  wake = std::min(wake, progress_due_);
  if (options_.run.duration.count() > 0) {
    wake = std::min(wake, *head_met_ + options_.run.duration);
  }
  if (options_.run.ping_wait.count() > 0) {
    wake = std::min(wake, last_ping_at_ + options_.run.ping_wait);
  }
  return std::max(wake, at);
}

ExitStatus WatchedHead::sum_up(std::uint64_t kernel_drops) {
  ProgramCounters counters;
  if (writer_) {
    if (last_ping_) {
      writer_->write(pictures_.of(std::move(*last_ping_), "last"));
    }
    writer_->finish();
    counters.images_written = writer_->written();
    counters.images_skipped = writer_->skipped();
    if (!writer_->error().empty()) {
      fmt::print(stderr, "{}{}\n", says_, printable(writer_->error()));
      failure_ = failure_.value_or(ExitStatus::system);
    }
  }
  counters.sonar_id = client_.head() ? client_.head()->status.sonar_id : sonar_id_;
  counters.rate_hz = rate_.hz();
  counters.dropped_rx = drop_rx_.dropped();
  counters.dropped_tx = drop_tx_.dropped();
  counters.kernel_drops = kernel_drops;
  const auto& statistics = client_.statistics();
  fmt::print("{}\n", summary_line(statistics, counters));
  std::fflush(stdout);
  const bool all_complete = statistics.pings_complete > 0 && statistics.pings_incomplete == 0;
  return failure_.value_or(all_complete ? ExitStatus::ok : ExitStatus::incomplete);
}

}  // namespace sonard::client
