// SPDX-License-Identifier: Apache-2.0
// Captures for tshark, and its output for them.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "protocol/pcapng/blocks.hpp"

namespace sonard::testing {

/// The values of one packet by field; repeated values of a field are separated by commas.
using Row = std::map<std::string, std::string>;

/// Writes `packets`, `apart` from each other, and runs tshark on them with all dissectors, checking all
/// checksums. @return one row for each packet. Fails the test if tshark fails or prints an error.
std::vector<Row> dissect(const std::vector<pcapng::Bytes>& packets, const std::vector<std::string>& fields,
                         const std::vector<std::string>& options = {},
                         std::chrono::nanoseconds apart = std::chrono::microseconds{1});

/// A datagram between a client and a head on the ports of the Gemini.
pcapng::Bytes to_head(pcapng::ByteView payload);
pcapng::Bytes from_head(pcapng::ByteView payload);

/// The field with the warnings of Wireshark and the dissectors.
inline const std::string expert_field = "_ws.expert.message";

}  // namespace sonard::testing
