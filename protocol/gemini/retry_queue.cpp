// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/retry_queue.hpp"

#include <algorithm>

namespace sonard::gemini {

void RetryQueue::reset(int line_count) {
  ranges_.clear();
  resends_.assign(static_cast<std::size_t>(line_count), 0);
}

bool RetryQueue::push(const RetryRequest& request) {
  switch (request.kind) {
    case RetryKind::lines:
      return push_lines(request.first_line, std::max<int>(1, request.line_count));
    case RetryKind::head:
    case RetryKind::tail:
      if (!ranges_.empty() && ranges_.back().kind == request.kind) {
        return true;
      }
      if (ranges_.size() >= max_ranges) {
        return false;
      }
      ranges_.push_back({request.kind, 0, 1});
      return true;
  }
  return false;  // unknown kind from the wire
}

bool RetryQueue::push_lines(int first, int count) {
  const int lines = static_cast<int>(resends_.size());
  if (first >= lines) {
    return false;
  }
  const int end = std::min(first + count, lines);
  if (!ranges_.empty() && ranges_.back().kind == RetryKind::lines) {
    Range& last = ranges_.back();
    const int last_end = last.first + last.count;
    if (first >= last.first && first <= last_end) {
      last.count = std::max(end, last_end) - last.first;
      return true;
    }
  }
  if (ranges_.size() >= max_ranges) {
    return false;
  }
  ranges_.push_back({RetryKind::lines, first, end - first});
  return true;
}

std::optional<RetryQueue::Resend> RetryQueue::pop() {
  while (!ranges_.empty()) {
    Range& range = ranges_.front();
    const Resend resend{range.kind, range.first};
    ++range.first;
    if (--range.count == 0) {
      ranges_.pop_front();
    }
    if (resend.kind != RetryKind::lines) {
      return Resend{resend.kind, 0};
    }
    std::uint8_t& resends = resends_[static_cast<std::size_t>(resend.line)];
    if (resends < max_resends) {
      ++resends;
      return resend;
    }
  }
  return std::nullopt;
}

int RetryQueue::pending(int limit) const {
  int total = 0;
  for (const Range& range : ranges_) {
    if (total >= limit) {
      break;
    }
    total += range.count;
  }
  return std::min(total, limit);
}

}  // namespace sonard::gemini
