// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/micron/viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/micron/line_file.hpp"
#include "clients/sonarview/micron/scan_log.hpp"
#include "clients/sonarview/micron/scan_sweeps.hpp"
#include "clients/sonarview/micron/sweep_pictures.hpp"

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

/// Everything on one thread but the drawing of pictures. The host lives as long as the program, whatever
/// becomes of the line: a head goes on when its host is away, and when neither speaks, time stands still for
/// the host.
class Viewer {
 public:
  explicit Viewer(const MicronOptions& options);

  ExitStatus run();

 private:
  void on_opened();
  void on_lost(const std::string& why);
  void advance();
  void take_line(const micron::ReceivedLine& line);
  void take_sweep(const Sweep& sweep);
  void greet_head();
  void show_progress(TimePoint at);
  void refresh_picture();
  std::string head_text() const;
  /// Ends the program when a limit is reached.
  void check_limits(TimePoint at);
  void give_up(ExitStatus failure, const std::string& message);
  void end();
  TimePoint next_wake() const;
  void arm_timer();
  ExitStatus sum_up();
  static bool limited(nanoseconds limit) { return limit.count() > 0; }

  const MicronOptions options_;
  boost::asio::io_context io_;
  SerialLine line_;
  boost::asio::steady_timer timer_{io_};
  boost::asio::signal_set signals_{io_, SIGINT, SIGTERM};

  const TimePoint started_ = now();
  micron::Host host_;
  ScanSweeps sweeps_;
  std::uint64_t sweeps_done_ = 0;
  std::uint64_t parameters_sent_ = 0;
  bool whole_sweep_drawn_ = false;

  std::optional<TimePoint> head_met_;
  std::optional<TimePoint> lost_at_;    ///< nothing: the line is open
  std::optional<TimePoint> retry_due_;  ///< nothing: the line is open, or being opened
  std::string trouble_;                 ///< why the line could not be opened last
  std::uint64_t reconnects_ = 0;
  TimePoint first_line_at_{};
  TimePoint last_line_at_{};
  TimePoint waiting_since_{};  ///< for the next line
  int last_bearing_ = 0;
  TimePoint progress_due_{};
  std::uint64_t lines_at_progress_ = 0;

  SweepPictures pictures_;
  std::optional<ImageWriter> writer_;
  std::optional<Sweep> last_sweep_;  ///< the last whole one, where pictures are wanted
  std::optional<LineFile> file_;
  std::optional<ExitStatus> failure_;
  bool ended_ = false;
};

Viewer::Viewer(const MicronOptions& options)
    : options_(options),
      line_(io_, options.line,
            {.opened = [this] { on_opened(); },
             .received =
                 [this](std::span<const std::uint8_t> bytes) {
                   host_.on_bytes(now(), bytes);
                   advance();
                 },
             .lost = [this](const std::string& why) { on_lost(why); }}),
      host_(options.host, started_),
      sweeps_(micron::make_head_command(options.scan)),
      lost_at_(started_),
      pictures_(options.scan, {.radius_px = options.radius_px}) {
  if (!options_.out.empty()) {
    writer_.emplace(options_.out);
  }
  if (!options_.raw.empty()) {
    file_.emplace(options_.raw);
  }
}

ExitStatus Viewer::run() {
  signals_.async_wait([this](const error_code& cancelled, int) {
    if (!cancelled) {
      end();
    }
  });
  fmt::print("{}\n", scan_text(options_.scan));
  std::fflush(stdout);
  host_.start(started_, micron::make_head_command(options_.scan), options_.lines);
  line_.open();
  arm_timer();
  io_.run();
  return sum_up();
}

// ---- The line

void Viewer::on_opened() {
  const TimePoint at = now();
  if (head_met_) {
    ++reconnects_;
    fmt::print(stderr, "sonarview: {} is open again\n", options_.line.text());
  }
  lost_at_.reset();
  trouble_.clear();
  waiting_since_ = at;
  advance();
}

void Viewer::on_lost(const std::string& why) {
  if (ended_) {
    return;
  }
  const TimePoint at = now();
  retry_due_ = at + retry_period;
  if (!lost_at_) {
    lost_at_ = at;
    fmt::print(stderr, "sonarview: lost {}: {}; trying again for {:.1f} s\n", options_.line.text(), why,
               seconds(options_.wait));
  } else if (why != trouble_) {  // said once, not at each try
    fmt::print(stderr, "sonarview: cannot open {}: {}; trying again\n", options_.line.text(), why);
  }
  trouble_ = why;
  advance();
}

// ---- The scan

void Viewer::advance() {
  if (ended_) {
    return;
  }
  const TimePoint at = now();
  if (line_.is_open()) {
    host_.advance(at);
    for (const auto& frame : host_.take_outgoing()) {
      line_.send(frame);
    }
  } else if (retry_due_ && at >= *retry_due_) {
    retry_due_.reset();
    line_.open();
  }
  if (!head_met_ && host_.statistics().frames > 0) {
    head_met_ = waiting_since_ = at;
    progress_due_ = at + progress_period;
  }
  for (const micron::ReceivedLine& line : host_.take_lines()) {
    if (!ended_) {
      take_line(line);
    }
  }
  if (std::exchange(parameters_sent_, host_.statistics().head_commands) != parameters_sent_) {
    sweeps_.restart();
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

void Viewer::take_line(const micron::ReceivedLine& line) {
  if (line.number == 0) {
    first_line_at_ = line.received;
  }
  last_line_at_ = waiting_since_ = line.received;
  last_bearing_ = line.head.bearing;
  const std::uint64_t sweep = sweeps_.current().number;
  if (options_.log_lines) {
    fmt::print("{}\n", line_text(line, sweep, micron::bin_length_m(options_.scan)));
    std::fflush(stdout);
  }
  if (file_) {
    file_->write(line, sweep);
  }
  if (const auto done = sweeps_.add(line)) {
    take_sweep(*done);
  }
}

void Viewer::take_sweep(const Sweep& sweep) {
  ++sweeps_done_;
  if (writer_) {
    std::vector<std::string> names{"last"};
    if (options_.every > 0 && sweep.number % options_.every == 0) {
      names.push_back(fmt::format("{:06}", sweep.number));
    }
    writer_->write(pictures_.of(sweep, names));
    whole_sweep_drawn_ = true;
    last_sweep_ = sweep;
  }
  if (options_.sweeps > 0 && sweeps_done_ >= options_.sweeps) {
    end();
  }
}

/// For whoever looks at the folder during a turn: the lines of this turn, and those of the last one where
/// this one has not come yet.
void Viewer::refresh_picture() {
  if (writer_ && !sweeps_.current().lines.empty()) {
    writer_->refresh(pictures_.of(with_lines_before(sweeps_.current(), last_sweep_), {"last"}));
  }
}

void Viewer::greet_head() {
  const auto& head = host_.head();
  if (options_.quiet || host_.statistics().head_commands != 1) {
    return;
  }
  fmt::print(stderr, "sonarview: head {} at {}", options_.host.node, options_.line.text());
  if (head.version) {
    fmt::print(stderr, ", serial number {}, software {:#04x}", head.version->serial_number,
               head.version->software_version);
  }
  if (head.user_blocks) {
    fmt::print(stderr, ", {} duplex", head.user_blocks->half_duplex() ? "half" : "full");
  }
  fmt::print(stderr, "\nsonarview: {} bins of {:.1f} mm: the head covers {:.3f} m of {:g} m\n",
             options_.scan.bins, 1e3 * micron::bin_length_m(options_.scan),
             micron::covered_range_m(options_.scan), options_.scan.range_m);
}

// ---- What is said meanwhile

std::string Viewer::head_text() const {
  const auto& alive = host_.head().alive;
  if (!line_.is_open()) {
    return "the line is lost";
  }
  if (!alive) {
    return "the head says nothing of its state";
  }
  const double bearing = micron::bearing_deg(alive->position);
  if (!alive->has(micron::head_info_bits::centred)) {
    return fmt::format("the head is centring, at {:+.1f} deg", bearing);
  }
  return fmt::format("the head {} parameters, at {:+.1f} deg",
                     alive->has(micron::head_info_bits::no_parameters) ? "waits for" : "has", bearing);
}

void Viewer::show_progress(TimePoint at) {
  progress_due_ = at + progress_period;
  const std::uint64_t lines = host_.statistics().lines;
  const std::uint64_t fresh = lines - std::exchange(lines_at_progress_, lines);
  if (options_.quiet) {
    return;
  }
  if (fresh == 0) {
    fmt::print(stderr, "sonarview: {} lines, none in the last second; {}\n", lines, head_text());
    return;
  }
  const std::string done =
      sweeps_.begun() ? fmt::format("turn {}, {:.0f} %", sweeps_.current().number, 100.0 * sweeps_.share())
                      : "on the way to the first limit";
  fmt::print(stderr, "sonarview: bearing {:+.1f} deg, {} lines, {} in the last second; {}\n",
             micron::bearing_deg(last_bearing_), lines, fresh, done);
}

// ---- Ends

void Viewer::check_limits(TimePoint at) {
  const bool out_of_time = head_met_ && limited(options_.duration) && at - *head_met_ >= options_.duration;
  const double wait_s = seconds(options_.wait);
  if (host_.finished() || out_of_time || ended_) {
    end();
  } else if (!head_met_ && at - started_ >= options_.wait) {
    give_up(ExitStatus::no_head,
            lost_at_ ? fmt::format("cannot open {} within {:.1f} s{}{}", options_.line.text(), wait_s,
                                   trouble_.empty() ? "" : ": ", trouble_)
                     : fmt::format("{} is open, but no head {} spoke within {:.1f} s: is it powered, is it "
                                   "this line, speed and node?",
                                   options_.line.text(), options_.host.node, wait_s));
  } else if (head_met_ && lost_at_ && at - *lost_at_ >= options_.wait) {
    give_up(ExitStatus::incomplete,
            fmt::format("{} did not come back within {:.1f} s: {}", options_.line.text(), wait_s, trouble_));
  } else if (head_met_ && !lost_at_ && limited(options_.line_wait) &&
             at - waiting_since_ >= options_.line_wait) {
    give_up(ExitStatus::incomplete,
            fmt::format("no line for {:.1f} s: {}", seconds(options_.line_wait), head_text()));
  }
}

void Viewer::give_up(ExitStatus failure, const std::string& message) {
  fmt::print(stderr, "sonarview: {}\n", message);
  failure_ = failure;
  end();
}

void Viewer::end() {
  if (std::exchange(ended_, true)) {
    return;
  }
  host_.stop();
  line_.close();
  io_.stop();
}

// ---- Time

TimePoint Viewer::next_wake() const {
  TimePoint wake = TimePoint::max();
  if (line_.is_open()) {
    wake = host_.next_deadline().value_or(wake);
  } else if (retry_due_) {
    wake = *retry_due_;
  }
  if (!head_met_) {
    return std::min(wake, started_ + options_.wait);
  }
  wake = std::min(wake, progress_due_);
  if (limited(options_.duration)) {
    wake = std::min(wake, *head_met_ + options_.duration);
  }
  if (lost_at_) {
    wake = std::min(wake, *lost_at_ + options_.wait);
  } else if (limited(options_.line_wait)) {
    wake = std::min(wake, waiting_since_ + options_.line_wait);
  }
  return wake;
}

void Viewer::arm_timer() {
  timer_.expires_at(std::chrono::steady_clock::time_point(next_wake()));
  timer_.async_wait([this](const error_code& cancelled) {
    if (!cancelled) {
      advance();
    }
  });
}

ExitStatus Viewer::sum_up() {
  const auto& statistics = host_.statistics();
  ScanCounters counters{
      .sweeps = sweeps_done_, .lines_missed = sweeps_.lines_missed(), .reconnects = reconnects_};
  if (writer_) {
    if (!whole_sweep_drawn_ && !sweeps_.current().lines.empty()) {
      writer_->write(pictures_.of(sweeps_.current(), {"last"}));
    }
    writer_->finish();
    counters.images_written = writer_->written();
    counters.images_skipped = writer_->skipped();
    if (!writer_->error().empty()) {
      fmt::print(stderr, "sonarview: {}\n", writer_->error());
      failure_ = failure_.value_or(ExitStatus::system);
    }
  }
  if (file_ && file_->failed()) {
    fmt::print(stderr, "sonarview: cannot write {}\n", file_->path().string());
    failure_ = failure_.value_or(ExitStatus::system);
  }
  if (const double span_s = seconds(last_line_at_ - first_line_at_); span_s > 0.0) {
    counters.rate_hz = static_cast<double>(statistics.lines - 1) / span_s;
  }
  fmt::print("{}\n", summary_text(statistics, counters));
  std::fflush(stdout);
  const bool all_there = statistics.lines > 0 && counters.lines_missed == 0;
  return failure_.value_or(all_there ? ExitStatus::ok : ExitStatus::incomplete);
}

}  // namespace

ExitStatus view_micron(const MicronOptions& options) {
  return Viewer(options).run();
}

}  // namespace sonard::client
