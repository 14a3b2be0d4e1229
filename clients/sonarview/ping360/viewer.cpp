// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/ping360/viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/crc.hpp>
#include <csignal>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/ping360/sweeps.hpp"
#include "protocol/ping360/units.hpp"
#include "renderer/picture/sweep_image.hpp"

namespace sonard::client {
namespace {

using boost::system::error_code;
using std::chrono::nanoseconds;

constexpr nanoseconds progress_period = std::chrono::seconds{1};
constexpr nanoseconds retry_period = std::chrono::milliseconds{500};
constexpr nanoseconds stop_patience = std::chrono::milliseconds{500};
constexpr double degrees_per_rad = 180.0 / std::numbers::pi;

TimePoint now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

double seconds(nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

picture::SweepShape shape_of(const Ping360Options& options) {
  constexpr double gradian_rad = 2.0 * std::numbers::pi / ping360::gradians_per_turn;
  picture::SweepShape shape;
  shape.step = picture::turn_units(options.scan.num_steps * gradian_rad);
  if (!options.all_round) {
    const int span = ping360::wrapped(options.scan.stop_angle - options.scan.start_angle);
    shape.left = picture::turn_bearing(ping360::bearing_rad(options.scan.start_angle, options.ahead));
    shape.width = picture::turn_units(span * gradian_rad);
  }
  shape.bins = options.scan.number_of_samples;
  shape.bin_m = options.bin_m();
  return shape;
}

/// What goes first: a turn of pings that are ordered one by one.
ping360::Transducer first_order(const ping360::AutoTransmit& scan) {
  ping360::Transducer order;
  ping360::copy_ping_settings(order, scan);
  order.angle = scan.start_angle;
  return order;
}

/// Everything on one thread but the drawing of pictures. The host lives as long as the program, whatever
/// becomes of the line.
class Viewer {
 public:
  explicit Viewer(const Ping360Options& options);

  ExitStatus run();

 private:
  void on_lost(const std::string& why);
  void advance();
  void talk(TimePoint at);
  void take_ping(const ping360::ReceivedPing& ping);
  void take_sweep(const Sweep360& sweep);
  std::vector<Picture> pictures_of(const Sweep360& sweep, const std::vector<std::string>& names) const;
  void greet_head();
  void show_progress(TimePoint at);
  void refresh_picture();
  void check_limits(TimePoint at);
  void give_up(ExitStatus failure, const std::string& message);
  void stop_head(TimePoint at);
  void end();
  void arm_timer();
  ExitStatus sum_up();
  static bool limited(nanoseconds limit) { return limit.count() > 0; }

  const Ping360Options options_;
  boost::asio::io_context io_;
  SerialLine line_;
  boost::asio::steady_timer timer_{io_};
  boost::asio::signal_set signals_{io_, SIGINT, SIGTERM};

  const TimePoint started_ = now();
  ping360::Host host_;
  SweepCollector sweeps_;
  std::uint64_t sweeps_done_ = 0;
  std::uint64_t pings_ = 0;
  bool whole_sweep_drawn_ = false;

  std::optional<TimePoint> head_met_;
  bool greeted_ = false;
  std::optional<TimePoint> retry_due_ = started_;  ///< nothing: the line is open, or being opened
  std::string trouble_;                            ///< why the line could not be opened last
  TimePoint first_ping_at_{};
  TimePoint last_ping_at_{};
  TimePoint waiting_since_{};  ///< for the next ping
  TimePoint progress_due_{};
  std::uint64_t pings_at_progress_ = 0;
  std::optional<TimePoint> stopping_until_;

  std::shared_ptr<const picture::SweepImage> image_;
  std::optional<ImageWriter> writer_;
  std::optional<Sweep360> last_sweep_;  ///< the last whole one, where pictures are wanted
  std::optional<ExitStatus> failure_;
};

Viewer::Viewer(const Ping360Options& options)
    : options_(options),
      line_(io_, options.line,
            {.opened = [this] { advance(); },
             .received =
                 [this](std::span<const std::uint8_t> bytes) {
                   host_.on_bytes(now(), bytes);
                   advance();
                 },
             .lost = [this](const std::string& why) { on_lost(why); }}),
      host_(started_),
      sweeps_(options.all_round),
      image_(std::make_shared<picture::SweepImage>(shape_of(options),
                                                   picture::FanStyle{.radius_px = options.radius_px})) {
  if (!options_.out.empty()) {
    writer_.emplace(options_.out);
  }
}

ExitStatus Viewer::run() {
  signals_.async_wait([this](const error_code& cancelled, int) {
    if (!cancelled) {
      stop_head(now());
    }
  });
  fmt::print(
      "scan range_m={:.3f} samples={} bin_m={:.5f} sample_period={} step={} start={} stop={} auto={}\n",
      options_.scan.number_of_samples * options_.bin_m(), options_.scan.number_of_samples, options_.bin_m(),
      options_.scan.sample_period, options_.scan.num_steps, options_.scan.start_angle,
      options_.scan.stop_angle, options_.automatic ? 1 : 0);
  std::fflush(stdout);
  if (options_.automatic) {
    host_.start(started_, options_.scan, options_.pings);
  } else {
    host_.start(started_, first_order(options_.scan), options_.scan.num_steps, options_.pings);
  }
  advance();
  io_.run();
  return sum_up();
}

void Viewer::on_lost(const std::string& why) {
  retry_due_ = now() + retry_period;
  if (why != trouble_) {  // said once, not at each try
    fmt::print(stderr, "sonarview: {}: {}; trying again\n", options_.line.text(), why);
  }
  trouble_ = why;
  advance();
}

void Viewer::advance() {
  const TimePoint at = now();
  if (io_.stopped()) {
    return;
  }
  if (!line_.is_open() && retry_due_ && at >= *retry_due_) {
    retry_due_.reset();
    line_.open();
  }
  talk(at);
  if (!head_met_ && host_.statistics().frames > 0) {
    head_met_ = waiting_since_ = at;
    progress_due_ = at + progress_period;
  }
  greet_head();
  for (const ping360::ReceivedPing& ping : host_.take_pings()) {
    if (!stopping_until_) {
      take_ping(ping);
    }
  }
  if (head_met_ && at >= progress_due_) {
    show_progress(at);
    refresh_picture();
  }
  check_limits(at);
  arm_timer();
}

void Viewer::talk(TimePoint at) {
  if (!line_.is_open()) {
    return;
  }
  host_.advance(at);
  for (const std::vector<std::uint8_t>& frame : host_.take_outgoing()) {
    line_.send(frame);
  }
}

void Viewer::take_ping(const ping360::ReceivedPing& ping) {
  if (pings_++ == 0) {
    first_ping_at_ = ping.received;
  }
  last_ping_at_ = waiting_since_ = ping.received;
  if (options_.log_pings) {
    const auto strongest = std::max_element(ping.samples.begin(), ping.samples.end());
    boost::crc_32_type crc;
    crc.process_bytes(ping.samples.data(), ping.samples.size());
    fmt::print(
        "ping number={} turn={} angle={} bearing_deg={:.5g} samples={} strongest={} strongest_m={:.3f} "
        "crc32={:08x}\n",
        ping.number, sweeps_.current().number, ping.form.settings.angle,
        ping360::bearing_rad(ping.form.settings.angle, options_.ahead) * degrees_per_rad, ping.samples.size(),
        ping.samples.empty() ? 0 : *strongest,
        (static_cast<double>(strongest - ping.samples.begin()) + 0.5) * options_.bin_m(), crc.checksum());
    std::fflush(stdout);
  }
  if (const auto done = sweeps_.add(ping)) {
    take_sweep(*done);
  }
}

void Viewer::take_sweep(const Sweep360& sweep) {
  ++sweeps_done_;
  if (writer_) {
    std::vector<std::string> names{"last"};
    if (options_.every > 0 && sweep.number % options_.every == 0) {
      names.push_back(fmt::format("{:06}", sweep.number));
    }
    writer_->write(pictures_of(sweep, names));
    whole_sweep_drawn_ = true;
    last_sweep_ = sweep;
  }
  if (options_.turns > 0 && sweeps_done_ >= options_.turns) {
    stop_head(now());
  }
}

std::vector<Picture> Viewer::pictures_of(const Sweep360& sweep, const std::vector<std::string>& names) const {
  auto lines = std::make_shared<std::vector<picture::SweepLine>>();
  for (const ping360::ReceivedPing& ping : sweep.pings) {
    lines->push_back({picture::turn_bearing(ping360::bearing_rad(ping.form.settings.angle, options_.ahead)),
                      ping.samples});
  }
  const picture::SweepShape shape = shape_of(options_);
  const std::string caption = fmt::format("Ping360   turn {}   {} pings   {:.1f} m", sweep.number,
                                          sweep.pings.size(), shape.range_m());
  std::vector<Picture> pictures;
  for (const std::string& name : names) {
    pictures.push_back({fmt::format("{}-{}.png", options_.all_round ? "turn" : "fan", name),
                        [image = image_, lines, caption] { return image->draw(*lines, caption); }});
    pictures.push_back({fmt::format("polar-{}.png", name),
                        [shape, lines] { return picture::sweep_polar_image(shape, *lines); }});
  }
  return pictures;
}

/// For whoever looks at the folder during a turn: the pings of this turn, and those of the last one where
/// this one has not come yet.
void Viewer::refresh_picture() {
  if (writer_ && !stopping_until_ && !sweeps_.current().pings.empty()) {
    writer_->refresh(pictures_of(with_pings_before(sweeps_.current(), last_sweep_), {"last"}));
  }
}

// ---- What is said meanwhile

void Viewer::greet_head() {
  const auto& information = host_.head().information;
  if (greeted_ || options_.quiet || !information) {
    return;
  }
  greeted_ = true;
  fmt::print(stderr, "sonarview: head at {}, device type {}, firmware {}.{}.{}\n", options_.line.text(),
             information->device_type, information->firmware_major, information->firmware_minor,
             information->firmware_patch);
}

void Viewer::show_progress(TimePoint at) {
  progress_due_ = at + progress_period;
  const std::uint64_t fresh = pings_ - std::exchange(pings_at_progress_, pings_);
  if (!options_.quiet) {
    fmt::print(stderr, "sonarview: {} pings, {} in the last second; turn {}, {} pings of it\n", pings_, fresh,
               sweeps_.current().number, sweeps_.current().pings.size());
  }
}

// ---- Ends

void Viewer::check_limits(TimePoint at) {
  const double wait_s = seconds(options_.wait);
  if (stopping_until_) {
    if (host_.finished() || at >= *stopping_until_) {
      end();
    }
  } else if (const auto& refusal = host_.refusal()) {
    give_up(ExitStatus::incomplete, "the head refuses: " + refusal->text);
  } else if (host_.finished() ||
             (head_met_ && limited(options_.duration) && at - *head_met_ >= options_.duration)) {
    stop_head(at);
  } else if (!head_met_ && at - started_ >= options_.wait) {
    give_up(ExitStatus::no_head,
            line_.is_open()
                ? fmt::format("{} is open, but no head spoke within {:.1f} s", options_.line.text(), wait_s)
                : fmt::format("cannot open {} within {:.1f} s{}{}", options_.line.text(), wait_s,
                              trouble_.empty() ? "" : ": ", trouble_));
  } else if (head_met_ && limited(options_.ping_wait) && at - waiting_since_ >= options_.ping_wait) {
    give_up(ExitStatus::incomplete, fmt::format("no ping for {:.1f} s", seconds(options_.ping_wait)));
  }
}

void Viewer::give_up(ExitStatus failure, const std::string& message) {
  fmt::print(stderr, "sonarview: {}\n", message);
  failure_ = failure;
  stop_head(now());
}

/// A head goes on scanning when its client is gone, so it is told.
void Viewer::stop_head(TimePoint at) {
  if (stopping_until_) {
    return;
  }
  stopping_until_ = at + (head_met_ ? stop_patience : nanoseconds{});
  host_.stop(at);
  talk(at);
  arm_timer();
}

void Viewer::end() {
  line_.close();
  io_.stop();
}

void Viewer::arm_timer() {
  TimePoint wake = now() + progress_period;
  const auto earlier = [&wake](const std::optional<TimePoint>& time) {
    wake = std::min(wake, time.value_or(wake));
  };
  earlier(retry_due_);
  earlier(stopping_until_);
  if (line_.is_open()) {
    earlier(host_.next_deadline());
  }
  timer_.expires_at(std::chrono::steady_clock::time_point(wake));
  timer_.async_wait([this](const error_code& cancelled) {
    if (!cancelled) {
      advance();
    }
  });
}

ExitStatus Viewer::sum_up() {
  std::uint64_t written = 0, skipped = 0;
  if (writer_) {
    if (!whole_sweep_drawn_ && !sweeps_.current().pings.empty()) {
      writer_->write(pictures_of(sweeps_.current(), {"last"}));
    }
    writer_->finish();
    written = writer_->written();
    skipped = writer_->skipped();
    if (!writer_->error().empty()) {
      fmt::print(stderr, "sonarview: {}\n", writer_->error());
      failure_ = failure_.value_or(ExitStatus::system);
    }
  }
  const double span_s = seconds(last_ping_at_ - first_ping_at_);
  const double rate_hz = span_s > 0.0 ? static_cast<double>(pings_ - 1) / span_s : 0.0;
  const ping360::HostStatistics& host = host_.statistics();
  fmt::print(
      "summary turns={} pings={} rate_hz={:.2f} commands={} timeouts={} pings_unwanted={} frames={} "
      "frames_bad={} "
      "bytes_dropped={} images_written={} images_skipped={}\n",
      sweeps_done_, pings_, rate_hz, host.commands, host.timeouts, host.pings_unwanted, host.frames,
      host.bad_frames, host.dropped_bytes, written, skipped);
  std::fflush(stdout);
  return failure_.value_or(pings_ > 0 ? ExitStatus::ok : ExitStatus::incomplete);
}

}  // namespace

ExitStatus view_ping360(const Ping360Options& options) {
  return Viewer(options).run();
}

}  // namespace sonard::client
