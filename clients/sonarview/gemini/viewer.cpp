// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/address_v4.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>
#include <cstdio>
#include <string>
#include <utility>

#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/gemini/datagram_dropper.hpp"
#include "clients/sonarview/gemini/ping_log.hpp"
#include "clients/sonarview/gemini/ping_pictures.hpp"
#include "clients/sonarview/gemini/sockets.hpp"
#include "protocol/common/endpoint.hpp"

namespace sonard::client {
namespace {

using boost::asio::ip::udp;
using boost::system::error_code;

constexpr std::size_t datagram_buffer_bytes = 2048;  // as in the libraries
constexpr int datagrams_a_turn = 256;                // then timers and signals have their turn
constexpr std::chrono::nanoseconds progress_period = std::chrono::seconds{1};

TimePoint now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

/// Everything on one thread but the writing of pictures.
class Viewer {
 public:
  explicit Viewer(const GeminiOptions& options);

  ExitStatus run();

 private:
  void wait_for_reports();
  void on_reports();
  void advance();
  void send_commands();
  void take_ping(gemini::ReceivedPing ping);
  void greet_head();
  void show_progress(TimePoint at);
  void refresh_picture();
  /// Ends the program when a limit is reached.
  void check_limits(TimePoint at);
  void end();
  TimePoint next_wake(TimePoint at) const;
  void arm_timer();
  ExitStatus sum_up();

  const GeminiOptions options_;
  boost::asio::io_context io_;
  udp::socket reports_;
  udp::socket commands_;
  boost::asio::steady_timer timer_{io_};
  TimePoint timer_due_ = TimePoint::max();
  boost::asio::signal_set signals_{io_, SIGINT, SIGTERM};

  gemini::Topside topside_;
  DatagramDropper drop_rx_;
  DatagramDropper drop_tx_;
  std::uint64_t kernel_drops_ = 0;
  bool send_failed_ = false;

  TimePoint started_ = now();
  std::optional<TimePoint> head_met_;
  TimePoint last_ping_at_{};
  TimePoint progress_due_{};
  std::uint64_t pings_at_progress_ = 0;
  PingRate rate_;
  std::optional<gemini::ReceivedPing> last_ping_;  ///< only while its picture may be wanted
  bool last_ping_shown_ = true;                    ///< its picture is there, or on its way
  PingPictures pictures_;
  std::optional<ImageWriter> writer_;
  std::optional<ExitStatus> failure_;
  bool ended_ = false;
};

Viewer::Viewer(const GeminiOptions& options)
    : options_(options),
      reports_(open_report_socket(io_, options.bind_address)),
      commands_(open_command_socket(io_, options.topside_address)),
      topside_(options.topside),
      drop_rx_(options.drop_rx, options.seed, 0),
      drop_tx_(options.drop_tx, options.seed, 1),
      pictures_({.radius_px = options.radius_px}, options.settings.sound_speed_mps) {
  if (!options_.out.empty()) {
    writer_.emplace(options_.out);
  }
}

ExitStatus Viewer::run() {
  signals_.async_wait([this](const error_code& cancelled, int) {
    if (!cancelled) {
      end();
    }
  });
  topside_.start(now(), make_ping_config(options_.settings), options_.pings);
  wait_for_reports();
  arm_timer();
  io_.run();
  return sum_up();
}

void Viewer::wait_for_reports() {
  reports_.async_wait(udp::socket::wait_read, [this](const error_code& cancelled) {
    if (!cancelled && !ended_) {
      on_reports();
      wait_for_reports();
    }
  });
}

void Viewer::on_reports() {
  std::array<std::uint8_t, datagram_buffer_bytes> buffer;
  for (int count = 0; count < datagrams_a_turn; ++count) {
    const auto size = receive(reports_, buffer, kernel_drops_);
    if (!size) {
      break;
    }
    if (!drop_rx_.drop()) {
      topside_.on_datagram(now(), std::span(buffer).first(*size));
    }
  }
  advance();
}

void Viewer::advance() {
  if (ended_) {
    return;
  }
  const TimePoint at = now();
  topside_.advance(at);
  send_commands();
  for (auto& ping : topside_.take_pings()) {
    take_ping(std::move(ping));
  }
  if (topside_.head() && !head_met_) {
    head_met_ = last_ping_at_ = at;
    progress_due_ = at + progress_period;
    greet_head();
  }
  if (head_met_ && at >= progress_due_) {
    show_progress(at);
    refresh_picture();
  }
  check_limits(at);
  if (!ended_) {
    arm_timer();
  }
}

void Viewer::send_commands() {
  for (const auto& datagram : topside_.take_outgoing()) {
    if (drop_tx_.drop()) {
      continue;
    }
    error_code error;
    commands_.send_to(boost::asio::buffer(datagram.bytes),
                      {boost::asio::ip::address_v4(datagram.to), gemini::head_port}, 0, error);
    if (error && !std::exchange(send_failed_, true)) {
      fmt::print(stderr, "sonarview: cannot send to {}:{}: {}\n", address_text(datagram.to),
                 gemini::head_port, error.message());
    }
  }
}

void Viewer::take_ping(gemini::ReceivedPing ping) {
  last_ping_at_ = ping.finished;
  rate_.add(ping.finished);
  if (options_.log_pings) {
    fmt::print("{}\n", ping_line(ping));
    std::fflush(stdout);
  }
  if (!writer_) {
    return;
  }
  if (options_.every > 0 && ping.number % options_.every == 0) {
    writer_->write(pictures_.of(ping, fmt::format("{:06}", ping.number)));
  }
  last_ping_ = std::move(ping);
  last_ping_shown_ = false;
}

/// For whoever looks at the folder while the program runs.
void Viewer::refresh_picture() {
  if (writer_ && last_ping_ && !std::exchange(last_ping_shown_, true)) {
    writer_->refresh(pictures_.of(*last_ping_, "last"));
  }
}

void Viewer::greet_head() {
  const auto& head = *topside_.head();
  const gemini::Status& status = head.status;
  if (!options_.quiet) {
    fmt::print(stderr, "sonarview: head {} at {}, netmask {}, firmware {:#06x}\n", status.sonar_id,
               address_text(head.address), address_text(status.subnet_mask), status.firmware_version);
  }
  const auto own_mask = interface_netmask(options_.topside_address);
  const bool same_network = ((head.address ^ options_.topside_address) & status.subnet_mask) == 0;
  if (!same_network || (own_mask && *own_mask != status.subnet_mask)) {
    fmt::print(stderr,
               "sonarview: warning: {} with netmask {} and {} with netmask {} are not on one network; the "
               "vendor's later "
               "libraries would send nothing\n",
               address_text(head.address), address_text(status.subnet_mask),
               address_text(options_.topside_address), own_mask ? address_text(*own_mask) : "unknown");
  }
}

void Viewer::show_progress(TimePoint at) {
  progress_due_ = at + progress_period;
  const auto& statistics = topside_.statistics();
  const std::uint64_t pings = statistics.pings_complete + statistics.pings_incomplete;
  if (!options_.quiet) {
    fmt::print(stderr, "sonarview: {} pings, {} in the last second; {} lines repaired, {} missing\n", pings,
               pings - pings_at_progress_, statistics.lines_repaired, statistics.lines_missing);
  }
  pings_at_progress_ = pings;
}

void Viewer::check_limits(TimePoint at) {
  const bool out_of_time = head_met_ && options_.duration.count() > 0 && at - *head_met_ >= options_.duration;
  if (topside_.finished() || out_of_time) {
    end();
  } else if (!head_met_ && at - started_ >= options_.status_wait) {
    fmt::print(stderr,
               "sonarview: no status{} on port {} within {:.1f} s: is sonard running, does it send its "
               "status to this "
               "address or broadcast it on this network, and does a firewall let UDP in?\n",
               options_.topside.sonar_id != 0 ? fmt::format(" of head {}", options_.topside.sonar_id) : "",
               gemini::topside_port, std::chrono::duration<double>(options_.status_wait).count());
    failure_ = ExitStatus::no_head;
    end();
  } else if (head_met_ && options_.ping_wait.count() > 0 && at - last_ping_at_ >= options_.ping_wait) {
    fmt::print(stderr,
               "sonarview: status comes, but no ping for {:.1f} s: can the head be reached at {}:{} from {}, "
               "and does it "
               "have a pose?\n",
               std::chrono::duration<double>(options_.ping_wait).count(),
               address_text(topside_.head()->address), gemini::head_port,
               address_text(options_.topside_address));
    failure_ = ExitStatus::incomplete;
    end();
  }
}

void Viewer::end() {
  if (std::exchange(ended_, true)) {
    return;
  }
  topside_.stop();
  send_commands();
  io_.stop();
}

TimePoint Viewer::next_wake(TimePoint at) const {
  TimePoint wake = topside_.next_deadline().value_or(TimePoint::max());
  if (!head_met_) {
    return std::min(wake, started_ + options_.status_wait);
  }
  wake = std::min(wake, progress_due_);
  if (options_.duration.count() > 0) {
    wake = std::min(wake, *head_met_ + options_.duration);
  }
  if (options_.ping_wait.count() > 0) {
    wake = std::min(wake, last_ping_at_ + options_.ping_wait);
  }
  return std::max(wake, at);
}

/// A timer that is due earlier stays: it looks again when it runs out. That saves arming it for each burst of
/// lines.
void Viewer::arm_timer() {
  const TimePoint wake = next_wake(now());
  if (wake >= timer_due_) {
    return;
  }
  timer_due_ = wake;
  timer_.expires_at(std::chrono::steady_clock::time_point(wake));
  timer_.async_wait([this](const error_code& cancelled) {
    if (!cancelled) {
      timer_due_ = TimePoint::max();
      advance();
    }
  });
}

ExitStatus Viewer::sum_up() {
  ProgramCounters counters;
  if (writer_) {
    if (last_ping_) {
      writer_->write(pictures_.of(std::move(*last_ping_), "last"));
    }
    writer_->finish();
    counters.images_written = writer_->written();
    counters.images_skipped = writer_->skipped();
    if (!writer_->error().empty()) {
      fmt::print(stderr, "sonarview: {}\n", writer_->error());
      failure_ = failure_.value_or(ExitStatus::system);
    }
  }
  counters.rate_hz = rate_.hz();
  counters.dropped_rx = drop_rx_.dropped();
  counters.dropped_tx = drop_tx_.dropped();
  counters.kernel_drops = kernel_drops_;
  const auto& statistics = topside_.statistics();
  fmt::print("{}\n", summary_line(statistics, counters));
  std::fflush(stdout);
  const bool all_complete = statistics.pings_complete > 0 && statistics.pings_incomplete == 0;
  return failure_.value_or(all_complete ? ExitStatus::ok : ExitStatus::incomplete);
}

}  // namespace

ExitStatus view_gemini(const GeminiOptions& options) {
  return Viewer(options).run();
}

}  // namespace sonard::client
