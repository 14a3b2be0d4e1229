// SPDX-License-Identifier: Apache-2.0
#include "server/pose/unreadable_messages.hpp"

#include <utility>

#include <fmt/format.h>

#include "common/text/counted.hpp"
#include "protocol/mavlink/frames.hpp"

namespace sonard::server {

void UnreadableMessages::note(TimePoint now, std::string sender, std::string problem) {
  if (count_ == 0 || now - newest_ >= worth_saying) {
    count_ = 0;
    sender_ = std::move(sender);
    problem_ = std::move(problem);
  }
  ++count_;
  newest_ = now;
}

std::string UnreadableMessages::text(TimePoint now) const {
  if (count_ == 0 || now - newest_ >= worth_saying) {
    return {};
  }
  return fmt::format("{}{}{} could not be read: {}.", counted(count_, "message"),
                     sender_.empty() ? "" : " from ", sender_, problem_);
}

std::string mavlink_hint(std::span<const std::uint8_t> bytes) {
  mavlink::FrameCounters counters;
  mavlink::FrameReader reader(bytes, counters);
  const bool frame_at_front = reader.next() && counters.stray_bytes == 0;
  return frame_at_front ? " (it looks like MAVLink: configure poses.mavlink, and send it by UDP to its bind "
                          "address)"
                        : "";
}

}  // namespace sonard::server
