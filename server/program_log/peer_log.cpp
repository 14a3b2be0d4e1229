// SPDX-License-Identifier: Apache-2.0
#include "server/program_log/peer_log.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

namespace sonard::server {

const Clock& PeerLog::real_time() {
  static const SteadyClock clock;
  return clock;
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
    spdlog::log(level, "{} ({} earlier lines were dropped: too many in a short time)", text, missing);
  } else {
    spdlog::log(level, "{}", text);
  }
}

}  // namespace sonard::server
