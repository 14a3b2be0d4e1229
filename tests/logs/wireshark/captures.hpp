// SPDX-License-Identifier: Apache-2.0
// Captures for tshark, and what it makes of them.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "protocol/pcapng/blocks.hpp"

namespace sonard::testing {

/// The values of one packet by field; of a field that is there several times, all of them with commas
/// between.
using Row = std::map<std::string, std::string>;

/// Writes `packets`, `apart` from each other, and has tshark read them with all dissectors and all
/// checksums checked. @return one row for each packet. Fails the test when tshark cannot, or complains.
std::vector<Row> dissect(const std::vector<pcapng::Bytes>& packets, const std::vector<std::string>& fields,
                         const std::vector<std::string>& options = {},
                         std::chrono::nanoseconds apart = std::chrono::microseconds{1});

/// A datagram between a topside and a head on the ports of the Gemini.
pcapng::Bytes to_head(pcapng::ByteView payload);
pcapng::Bytes from_head(pcapng::ByteView payload);

/// What Wireshark and the dissectors complain about.
inline const std::string expert_field = "_ws.expert.message";

}  // namespace sonard::testing
