// SPDX-License-Identifier: Apache-2.0
// Pings as a viewer gets them: one binary message of a WebSocket.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "server/devices/ping_viewer.hpp"

namespace sonard::server {

/// A ping of a fan, or lines of a scanning head of one size, the oldest first. All little endian:
/// u32 length of the header; the header, JSON, with spaces up to a multiple of four bytes; float32 bearing of
/// each beam or line in radians, positive to port (REP-103); u8 samples. Of a fan row after row from near to
/// far, each from port to starboard; of a scanning head line after line, each from near to far.
/// @param pings one or more
/// @param max_rows >= 1; a ping of more is reduced: each row shows the largest of its neighbours
/// @param now for the age in the header, on the clock of ShownPing::time
std::string live_frame(std::span<const std::shared_ptr<const ShownPing>> pings, int max_rows, TimePoint now);

}  // namespace sonard::server
