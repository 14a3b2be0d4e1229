// SPDX-License-Identifier: Apache-2.0
// Pings in the form for viewers: one binary message of a WebSocket.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "server/devices/ping_viewer.hpp"

namespace sonard::server {

/// Encodes a ping of a fan, or lines of a scanning head of one size, oldest first. All little endian: u32
/// length of the header; the header, JSON, padded with spaces to a multiple of four bytes; float32 bearing of
/// each beam or line in radians, positive to port (REP-103); u8 samples. Of a fan, samples are row after row
/// from near to far, each from port to starboard. Of a scanning head they are line after line, each from near
/// to far.
/// @param pings one or more
/// @param max_rows >= 1; a ping with more rows is reduced: each row has the largest of the merged samples
/// @param now for the age in the header, on the clock of ShownPing::time
std::string live_frame(std::span<const std::shared_ptr<const ShownPing>> pings, int max_rows, TimePoint now);

}  // namespace sonard::server
