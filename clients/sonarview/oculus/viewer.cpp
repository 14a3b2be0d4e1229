// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/oculus/viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/crc.hpp>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/common/serial_line.hpp"
#include "clients/sonarview/oculus/ping_pictures.hpp"
#include "clients/sonarview/oculus/status_listener.hpp"
#include "protocol/oculus/codec.hpp"
#include "protocol/oculus/host.hpp"

namespace sonard::client {
namespace {

using boost::system::error_code;
using std::chrono::nanoseconds;

constexpr nanoseconds progress_period = std::chrono::seconds{1};
constexpr nanoseconds retry_period = std::chrono::milliseconds{500};

TimePoint now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

double seconds(nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

/// What a head may say of any length and with any characters.
std::string one_line(std::string text) {
  constexpr std::size_t longest = 200;
  text.resize(std::min(text.size(), longest));
  std::ranges::replace_if(
      text, [](char c) { return c < ' ' || c > '~'; }, ' ');
  return text;
}

/// Everything on one thread but the drawing of pictures.
class Viewer {
 public:
  explicit Viewer(const OculusOptions& options);

  ExitStatus run();

 private:
  void meet(const oculus::Status& status);
  void connect_to(const std::string& address);
  void on_opened();
  void on_lost(const std::string& why);
  void advance();
  void take_ping(oculus::ReceivedPing ping);
  void show_progress(TimePoint at);
  void check_limits(TimePoint at);
  void give_up(ExitStatus failure, const std::string& message);
  void end();
  void arm_timer();
  ExitStatus sum_up();
  static bool limited(nanoseconds limit) { return limit.count() > 0; }

  const OculusOptions options_;
  boost::asio::io_context io_;
  std::optional<StatusListener> statuses_;  ///< until the head is known
  std::unique_ptr<SerialLine> line_;        ///< from then on
  boost::asio::steady_timer timer_{io_};
  boost::asio::signal_set signals_{io_, SIGINT, SIGTERM};

  const TimePoint started_ = now();
  oculus::Host host_;
  std::uint64_t pings_ = 0;
  std::string address_;
  std::string trouble_;                             ///< why the head could not be connected to last
  std::optional<TimePoint> retry_due_;              ///< nothing: it is connected, or being connected to
  std::optional<TimePoint> lost_since_ = started_;  ///< nothing: it is connected
  std::optional<TimePoint> head_met_;
  TimePoint first_ping_at_{};
  TimePoint last_ping_at_{};
  TimePoint waiting_since_{};  ///< for the next ping
  TimePoint progress_due_{};
  std::uint64_t pings_at_progress_ = 0;

  OculusPictures pictures_;
  std::optional<ImageWriter> writer_;
  std::optional<oculus::ReceivedPing> last_ping_;  ///< where pictures are wanted
  std::optional<ExitStatus> failure_;
};

Viewer::Viewer(const OculusOptions& options)
    : options_(options), pictures_(picture::FanStyle{.radius_px = options.radius_px}) {
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
  if (options_.head.empty()) {
    statuses_.emplace(io_, Endpoint{options_.bind_address, options_.status_port},
                      [this](const oculus::Status& status) { meet(status); });
  } else {
    connect_to(options_.head);
  }
  arm_timer();
  io_.run();
  return sum_up();
}

void Viewer::meet(const oculus::Status& status) {
  const auto& octets = status.address;
  const auto& client = status.client;
  if (!options_.quiet) {
    fmt::print(stderr, "sonarview: head {}, part {}, at {}.{}.{}.{}{}\n", status.device_id,
               status.part_number, octets[0], octets[1], octets[2], octets[3],
               client == decltype(status.client){} ? "" : ", which has a client already");
  }
  statuses_->close();
  connect_to(fmt::format("{}.{}.{}.{}", octets[0], octets[1], octets[2], octets[3]));
}

void Viewer::connect_to(const std::string& address) {
  address_ = address;
  line_ = std::make_unique<SerialLine>(
      io_, LineAddress{.way = LineAddress::Way::tcp, .place = address, .port = options_.port},
      SerialLine::Events{.opened = [this] { on_opened(); },
                         .received =
                             [this](std::span<const std::uint8_t> bytes) {
                               host_.receive(now(), bytes);
                               advance();
                             },
                         .lost = [this](const std::string& why) { on_lost(why); }});
  line_->open();
}

void Viewer::on_opened() {
  lost_since_.reset();
  host_.connected();
  line_->send(oculus::encode(options_.fire));
  const TimePoint at = now();
  waiting_since_ = at;
  if (!head_met_) {
    head_met_ = at;
    progress_due_ = at + progress_period;
  }
  advance();
}

void Viewer::on_lost(const std::string& why) {
  const TimePoint at = now();
  lost_since_ = lost_since_.value_or(at);
  retry_due_ = at + retry_period;
  if (why != trouble_) {  // said once, not at each try
    fmt::print(stderr, "sonarview: {} port {}: {}; trying again\n", address_, options_.port, why);
  }
  trouble_ = why;
  advance();
}

void Viewer::advance() {
  if (io_.stopped()) {
    return;
  }
  const TimePoint at = now();
  if (retry_due_ && at >= *retry_due_) {
    retry_due_.reset();
    line_->open();
  }
  for (const std::string& text : host_.take_logs()) {
    if (!options_.quiet) {
      fmt::print(stderr, "sonarview: the head says: {}\n", one_line(text));
    }
  }
  for (oculus::ReceivedPing& ping : host_.take_pings()) {
    take_ping(std::move(ping));
  }
  if (head_met_ && at >= progress_due_) {
    show_progress(at);
  }
  check_limits(at);
  arm_timer();
}

void Viewer::take_ping(oculus::ReceivedPing ping) {
  if (options_.pings > 0 && pings_ >= options_.pings) {
    return;
  }
  if (pings_++ == 0) {
    first_ping_at_ = ping.received;
  }
  last_ping_at_ = waiting_since_ = ping.received;
  const oculus::PingResult& result = ping.result;
  if (options_.log_pings) {
    boost::crc_32_type crc;
    crc.process_bytes(result.image.data(), result.image.size());
    fmt::print(
        "ping id={} mode={} frequency_hz={:.0f} ranges={} beams={} resolution_m={:.6f} bits={} gain={:.1f} "
        "sound_speed={:.2f} start_s={:.6f} bytes={} crc32={:08x}\n",
        result.ping_id, result.fire.fire.master_mode, result.frequency_hz, result.ranges, result.beams,
        result.range_resolution_m, 8 * (static_cast<int>(result.data_size) + 1),
        result.fire.fire.gain_percent, result.sound_speed_mps, result.start_time_s, ping.message.size(),
        crc.checksum());
    std::fflush(stdout);
  }
  if (writer_) {
    if (options_.every > 0 && pings_ % options_.every == 0) {
      writer_->write(pictures_.of(ping, fmt::format("{:06}", pings_)));
    }
    last_ping_ = std::move(ping);
  }
}

void Viewer::show_progress(TimePoint at) {
  progress_due_ = at + progress_period;
  const std::uint64_t fresh = pings_ - std::exchange(pings_at_progress_, pings_);
  if (!options_.quiet) {
    fmt::print(stderr, "sonarview: {} pings, {} in the last second; {} missed\n", pings_, fresh,
               host_.statistics().pings_missed);
  }
  if (writer_ && last_ping_) {  // for whoever looks at the folder meanwhile
    writer_->refresh(pictures_.of(*last_ping_, "last"));
  }
}

// ---- Ends

void Viewer::check_limits(TimePoint at) {
  const double wait_s = seconds(options_.wait);
  const bool out_of_time = head_met_ && limited(options_.duration) && at - *head_met_ >= options_.duration;
  if (out_of_time || (options_.pings > 0 && pings_ >= options_.pings)) {
    end();
  } else if (lost_since_ && at - *lost_since_ >= options_.wait) {
    give_up(ExitStatus::no_head,
            address_.empty()
                ? fmt::format("no status on port {} within {:.1f} s: is sonard running, does it send its "
                              "status to this address or broadcast it on this network, and does a firewall "
                              "let UDP in?",
                              options_.status_port, wait_s)
                : fmt::format("cannot connect to {} port {} within {:.1f} s{}{}", address_, options_.port,
                              wait_s, trouble_.empty() ? "" : ": ", trouble_));
  } else if (head_met_ && limited(options_.ping_wait) && at - waiting_since_ >= options_.ping_wait) {
    give_up(ExitStatus::incomplete,
            fmt::format("no ping for {:.1f} s: does the head have a pose?", seconds(options_.ping_wait)));
  }
}

void Viewer::give_up(ExitStatus failure, const std::string& message) {
  fmt::print(stderr, "sonarview: {}\n", message);
  failure_ = failure;
  end();
}

void Viewer::end() {
  if (line_) {
    line_->close();
  }
  io_.stop();
}

void Viewer::arm_timer() {
  TimePoint wake = now() + progress_period;
  wake = std::min(wake, retry_due_.value_or(wake));
  if (head_met_ && limited(options_.duration)) {
    wake = std::min(wake, *head_met_ + options_.duration);
  }
  if (lost_since_) {
    wake = std::min(wake, *lost_since_ + options_.wait);
  }
  timer_.expires_at(std::chrono::steady_clock::time_point(wake));
  timer_.async_wait([this](const error_code& cancelled) {
    if (!cancelled) {
      advance();
    }
  });
}

ExitStatus Viewer::sum_up() {
  std::uint64_t written = 0;
  std::uint64_t skipped = 0;
  if (writer_) {
    if (last_ping_) {
      writer_->write(pictures_.of(std::move(*last_ping_), "last"));
    }
    writer_->finish();
    written = writer_->written();
    skipped = writer_->skipped();
    if (!writer_->error().empty()) {
      fmt::print(stderr, "sonarview: {}\n", writer_->error());
      failure_ = failure_.value_or(ExitStatus::system);
    }
  }
  const oculus::HostStatistics& host = host_.statistics();
  const double span_s = seconds(last_ping_at_ - first_ping_at_);
  fmt::print(
      "summary pings={} rate_hz={:.2f} pings_missed={} messages={} messages_bad={} bytes_dropped={} "
      "images_written={} images_skipped={}\n",
      pings_, span_s > 0.0 ? static_cast<double>(pings_ - 1) / span_s : 0.0, host.pings_missed, host.messages,
      host.bad_messages, host.dropped_bytes, written, skipped);
  std::fflush(stdout);
  const bool all = pings_ > 0 && host.pings_missed == 0 && host.bad_messages == 0;
  return failure_.value_or(all ? ExitStatus::ok : ExitStatus::incomplete);
}

}  // namespace

ExitStatus view_oculus(const OculusOptions& options) {
  return Viewer(options).run();
}

}  // namespace sonard::client
