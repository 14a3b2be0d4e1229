// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/line_viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "common/text/printable.hpp"

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

}  // namespace

std::string foreign_bytes_text(std::uint64_t bytes, std::string_view head) {
  return fmt::format(
      "{} bytes arrived that are not of {} (is another type of device there? Check address, port and baud "
      "rate)",
      bytes, head);
}

LineViewer::LineViewer(const RunOptions& options) : options_(options), started_(now()) {
  if (!options_.out.empty()) {
    writer_.emplace(options_.out);
  }
}

ExitStatus LineViewer::run() {
  signals_.async_wait([this](const error_code& cancelled, int) {
    if (!cancelled) {
      stop();
      advance();
    }
  });
  begin(started_);
  if (!options_.quiet) {
    fmt::print(stderr, "sonarview: waiting up to {:.1f} s for {}\n", seconds(options_.wait),
               printable(awaited_text()));
  }
  advance();
  io_.run();
  return end_status();
}

// ---- The line

void LineViewer::open_line(const LineAddress& address) {
  lost_at_ = now();
  line_text_ = address.text();
  line_.emplace(io_, address,
                SerialLine::Events{.opened = [this] { line_opened(); },
                                   .received =
                                       [this](std::span<const std::uint8_t> bytes) {
                                         line_speaks();
                                         on_bytes(now(), bytes);
                                         advance();
                                       },
                                   .lost = [this](const std::string& why) { line_lost(why); }});
  line_->open();
}

void LineViewer::line_opened() {
  waiting_since_ = now();
  on_opened();
  advance();
}

/// A line that closes right after each opening stays lost: only its first byte ends the loss.
void LineViewer::line_speaks() {
  if (!lost_at_) {
    return;
  }
  if (spoke_) {
    ++counters_.reconnects;
    fmt::print(stderr, "sonarview: {} is open again\n", printable(line_text_));
  }
  spoke_ = true;
  lost_at_.reset();
  trouble_.clear();
}

void LineViewer::line_lost(const std::string& why) {
  if (stopping()) {
    end();
    return;
  }
  const TimePoint at = now();
  retry_due_ = at + retry_period;
  if (!lost_at_) {
    lost_at_ = at;
    fmt::print(stderr, "sonarview: lost {}: {}; retrying for {:.1f} s\n", printable(line_text_),
               printable(why), seconds(options_.wait));
  } else if (why != trouble_) {  // logged once, not at each try
    fmt::print(stderr, "sonarview: cannot open {}: {}; retrying\n", printable(line_text_), printable(why));
  }
  trouble_ = why;
  advance();
}

// ---- The conversation

void LineViewer::advance() {
  if (io_.stopped()) {
    return;
  }
  const TimePoint at = now();
  if (retry_due_ && at >= *retry_due_ && !stopping()) {
    retry_due_.reset();
    line_->open();
  }
  if (line_is_open()) {
    talk(at);
  }
  if (!met_at_ && head_met()) {
    met_at_ = waiting_since_ = at;
    progress_due_ = at + progress_period;
  }
  if (!stopping()) {
    take_received();
  }
  if (met_at_ && at >= progress_due_ && !stopping()) {
    show_progress(at);
  }
  check_limits(at);
  arm_timer();
}

void LineViewer::count_ping(TimePoint received) {
  if (counters_.pings++ == 0) {
    first_ping_at_ = received;
  }
  last_ping_at_ = waiting_since_ = received;
}

void LineViewer::show_progress(TimePoint at) {
  progress_due_ = at + progress_period;
  const std::uint64_t fresh = counters_.pings - std::exchange(pings_at_progress_, counters_.pings);
  if (!options_.quiet) {
    fmt::print(stderr, "sonarview: {}\n", progress_text(fresh));
  }
  if (writer_) {
    refresh_pictures(*writer_);
  }
}

// ---- Ends

void LineViewer::check_limits(TimePoint at) {
  const double wait_s = seconds(options_.wait);
  const auto over = [at](TimePoint since, nanoseconds limit) {
    return limit.count() > 0 && at - since >= limit;
  };
  if (stopping()) {
    if (finished() || at >= *stopping_until_) {
      end();
    }
  } else if (finished() || (met_at_ && over(*met_at_, options_.duration))) {
    stop();
  } else if (line_ && !line_is_open() && lost_at_ && over(*lost_at_, options_.wait)) {
    const std::string why =
        fmt::format("within {:.1f} s: {}", wait_s, trouble_.empty() ? "no answer" : trouble_);
    if (spoke_) {
      give_up(ExitStatus::incomplete, line_text_ + " did not open again " + why);
    } else {
      give_up(ExitStatus::no_head, "cannot open " + line_text_ + " " + why + not_open_advice());
    }
  } else if (!met_at_ && (!line_ || line_is_open()) && over(waiting_since_, options_.wait)) {
    give_up(ExitStatus::no_head, no_head_text(wait_s));
  } else if (met_at_ && line_is_open() && over(waiting_since_, options_.ping_wait)) {
    give_up(ExitStatus::incomplete, no_ping_text(seconds(options_.ping_wait)));
  }
}

void LineViewer::fail(ExitStatus failure, const std::string& message) {
  fmt::print(stderr, "sonarview: {}\n", printable(message));
  failure_ = failure_.value_or(failure);
}

void LineViewer::give_up(ExitStatus failure, const std::string& message) {
  fail(failure, message);
  stop();
}

void LineViewer::stop() {
  if (stopping()) {
    return;
  }
  const TimePoint at = now();
  const nanoseconds patience = say_goodbye(at);
  stopping_until_ = at + (line_is_open() ? patience : nanoseconds{});
  if (line_is_open()) {
    talk(at);
  }
}

void LineViewer::end() {
  if (line_) {
    line_->close();
  }
  io_.stop();
}

void LineViewer::arm_timer() {
  TimePoint wake = now() + progress_period;
  const auto earlier = [&wake](bool matters, TimePoint time) {
    wake = matters ? std::min(wake, time) : wake;
  };
  const auto at_limit = [&earlier](bool matters, TimePoint since, nanoseconds limit) {
    earlier(matters && limit.count() > 0, since + limit);
  };
  const bool open = line_is_open();
  if (const auto due = next_deadline(); due && open) {
    earlier(true, *due);
  }
  if (stopping()) {
    earlier(true, *stopping_until_);
  } else {
    const bool met = met_at_.has_value();
    earlier(retry_due_.has_value(), retry_due_.value_or(wake));
    earlier(met, progress_due_);
    at_limit(met, met_at_.value_or(wake), options_.duration);
    at_limit(!met && (!line_ || open), waiting_since_, options_.wait);
    at_limit(line_ && !open && lost_at_, lost_at_.value_or(wake), options_.wait);
    at_limit(met && open, waiting_since_, options_.ping_wait);
  }
  timer_.expires_at(std::chrono::steady_clock::time_point(wake));
  timer_.async_wait([this](const error_code& cancelled) {
    if (!cancelled) {
      advance();
    }
  });
}

ExitStatus LineViewer::end_status() {
  if (writer_) {
    finish_pictures(*writer_);
    writer_->finish();
    counters_.images_written = writer_->written();
    counters_.images_skipped = writer_->skipped();
    if (!writer_->error().empty()) {
      fail(ExitStatus::system, writer_->error());
    }
  }
  if (const double span_s = seconds(last_ping_at_ - first_ping_at_); span_s > 0.0) {
    counters_.rate_hz = static_cast<double>(counters_.pings - 1) / span_s;
  }
  const bool all = sum_up(counters_);
  std::fflush(stdout);
  return failure_.value_or(all ? ExitStatus::ok : ExitStatus::incomplete);
}

}  // namespace sonard::client
