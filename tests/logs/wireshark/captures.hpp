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

/// All messages of a device, `piece` bytes at a time that begin and end anywhere in messages: first those to
/// the head, then those from it.
std::vector<pcapng::Bytes> pieces_over_tcp(const std::string& device, pcapng::TcpConversation line,
                                           std::size_t piece);
std::vector<pcapng::Bytes> pieces_over_udp(const std::string& device, pcapng::Endpoint client,
                                           pcapng::Endpoint head, std::size_t piece);
std::vector<pcapng::ByteView> pieces_of(pcapng::ByteView bytes, std::size_t piece);

/// The names of these messages, each followed by a comma.
std::string names_in_pieces(const std::string& device);

/// The values of `fields` in all packets, each followed by a comma; without fields that no packet has.
Row found_in(const std::vector<pcapng::Bytes>& packets, const std::vector<std::string>& fields,
             const std::vector<std::string>& options = {});

/// The field with the warnings of Wireshark and the dissectors.
inline const std::string expert_field = "_ws.expert.message";

}  // namespace sonard::testing
