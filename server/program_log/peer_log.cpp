// SPDX-License-Identifier: Apache-2.0
#include "server/program_log/peer_log.hpp"

#include <algorithm>
#include <new>
#include <utility>

#include <spdlog/spdlog.h>

namespace sonard::server {

const Clock& PeerLog::real_time() {
  static const SteadyClock clock;
  return clock;
}

void PeerLog::say(spdlog::level::level_enum level, fmt::string_view format, fmt::format_args args) {
  try {
    say(level, fmt::vformat(format, args));
  } catch (const std::bad_alloc&) {
    ++left_out_;
    lacked_memory_ = true;
  }
}

void PeerLog::say(spdlog::level::level_enum level, const std::string& text) {
  const TimePoint now = clock_.now();
  if (tokens_ == burst) {
    refilled_at_ = now;
  }
  const auto earned = (now - refilled_at_) / refill;
  tokens_ = static_cast<int>(std::min<std::int64_t>(burst, tokens_ + earned));
  refilled_at_ += earned * refill;
  const bool new_reason = reasons_.count(text) == 1;
  if (tokens_ == 0 && !new_reason) {
    ++left_out_;
    return;
  }
  tokens_ = std::max(0, tokens_ - 1);
  if (const std::uint64_t missing = std::exchange(left_out_, 0); missing > 0) {
    spdlog::log(level, "{} ({} earlier lines were dropped: too many in a short time{})", text, missing,
                std::exchange(lacked_memory_, false) ? ", or out of memory" : "");
  } else {
    spdlog::log(level, "{}", text);
  }
}

}  // namespace sonard::server
