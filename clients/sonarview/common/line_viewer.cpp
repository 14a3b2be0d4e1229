// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/line_viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace sonard::client {
namespace {

using boost::system::error_code;
using std::chrono::nanoseconds;

constexpr nanoseconds retry_period = std::chrono::milliseconds{500};

}  // namespace

std::string foreign_bytes_text(std::uint64_t bytes, std::string_view head) {
  return fmt::format(
      "{} bytes arrived that are not of {} (is another type of device there? Check address, port and baud "
      "rate)",
      bytes, head);
}

ExitStatus LineViewer::run() {
  signals_.async_wait([this](const error_code& cancelled, int) {
    if (!cancelled) {
      stop();
      advance();
    }
  });
  begin(started());
  say(fmt::format("waiting up to {:.1f} s for {}", in_seconds(options_.wait), awaited_text()));
  advance();
  io_.run();
  return end_status();
}

// ---- The line

void LineViewer::open_line(const LineAddress& address) {
  lost_at_ = steady_now();
  line_text_ = address.text();
  line_.emplace(io_, address,
                SerialLine::Events{.opened = [this] { line_opened(); },
                                   .received =
                                       [this](std::span<const std::uint8_t> bytes) {
                                         line_speaks();
                                         on_bytes(steady_now(), bytes);
                                         advance();
                                       },
                                   .lost = [this](const std::string& why) { line_lost(why); }});
  line_->open();
}

void LineViewer::line_opened() {
  run_.wait_from(steady_now());
  on_opened();
  advance();
}

/// A line that closes right after each opening stays lost: only its first byte ends the loss.
void LineViewer::line_speaks() {
  if (!lost_at_) {
    return;
  }
  if (spoke_) {
    ++run_.counters().reconnects;
    run_.warn(line_text_ + " is open again");
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
  const TimePoint at = steady_now();
  retry_due_ = at + retry_period;
  if (!lost_at_) {
    lost_at_ = at;
    run_.warn(fmt::format("lost {}: {}; retrying for {:.1f} s", line_text_, why, in_seconds(options_.wait)));
  } else if (why != trouble_) {  // logged once, not at each try
    run_.warn(fmt::format("cannot open {}: {}; retrying", line_text_, why));
  }
  trouble_ = why;
  advance();
}

// ---- The conversation

void LineViewer::advance() {
  if (io_.stopped()) {
    return;
  }
  const TimePoint at = steady_now();
  if (retry_due_ && at >= *retry_due_ && !stopping()) {
    retry_due_.reset();
    line_->open();
  }
  if (line_is_open()) {
    talk(at);
  }
  if (!run_.met() && head_met()) {
    run_.meet(at);
  }
  if (!stopping()) {
    take_received();
  }
  if (const auto fresh = stopping() ? std::nullopt : run_.fresh_pings(at)) {
    say(progress_text(*fresh));
    if (ImageWriter* const to = writer()) {
      refresh_pictures(*to);
    }
  }
  check_limits(at);
  arm_timer();
}

// ---- Ends

void LineViewer::check_limits(TimePoint at) {
  if (stopping()) {
    if (finished() || at >= *stopping_until_) {
      end();
    }
    return;
  }
  const HeadRun::Limit limit = run_.limit(at, listens());
  if (finished() || limit == HeadRun::Limit::duration) {
    stop();
  } else if (!listens() && lost_at_ && at - *lost_at_ >= options_.wait) {
    const std::string why = fmt::format("within {:.1f} s: {}", in_seconds(options_.wait),
                                        trouble_.empty() ? "no answer" : trouble_);
    if (spoke_) {
      give_up(ExitStatus::incomplete, line_text_ + " did not open again " + why);
    } else {
      give_up(ExitStatus::no_head, "cannot open " + line_text_ + " " + why + not_open_advice());
    }
  } else if (limit == HeadRun::Limit::no_head) {
    give_up(ExitStatus::no_head, no_head_text(in_seconds(options_.wait)));
  } else if (limit == HeadRun::Limit::no_ping) {
    give_up(ExitStatus::incomplete, no_ping_text(in_seconds(options_.ping_wait)));
  }
}

void LineViewer::give_up(ExitStatus failure, const std::string& message) {
  fail(failure, message);
  stop();
}

void LineViewer::stop() {
  if (stopping()) {
    return;
  }
  const TimePoint at = steady_now();
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
  TimePoint wake = stopping() ? *stopping_until_ : run_.next_wake(listens());
  const auto earlier = [&wake](const std::optional<TimePoint>& time) {
    wake = std::min(wake, time.value_or(wake));
  };
  if (line_is_open()) {
    earlier(next_deadline());
  }
  if (!stopping() && !line_is_open()) {
    earlier(retry_due_);
    earlier(lost_at_ ? std::optional(*lost_at_ + options_.wait) : std::nullopt);
  }
  timer_.expires_at(std::chrono::steady_clock::time_point(wake));
  timer_.async_wait([this](const error_code& cancelled) {
    if (!cancelled) {
      advance();
    }
  });
}

ExitStatus LineViewer::end_status() {
  if (ImageWriter* const to = writer()) {
    finish_pictures(*to);
  }
  run_.finish();
  const bool all = sum_up(run_.counters());
  std::fflush(stdout);
  return run_.status(all);
}

}  // namespace sonard::client
