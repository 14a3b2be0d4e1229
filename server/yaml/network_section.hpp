// SPDX-License-Identifier: Apache-2.0
// The parts of the loader that read how clients connect to a head.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <vector>

#include "server/net/addresses.hpp"
#include "server/net/faulty_link.hpp"
#include "server/net/serial_port.hpp"
#include "server/yaml/yaml_section.hpp"

namespace sonard::server {

inline constexpr TextForm endpoint_form{
    "an address and port such as 127.0.0.1:14600", "address:port",
    R"("type": "string", "pattern": "^[0-9]{1,3}(\\.[0-9]{1,3}){3}:[0-9]{1,5}$")", true};

inline constexpr std::string_view address_schema =
    R"("type": "string", "pattern": "^[0-9]{1,3}(\\.[0-9]{1,3}){3}$")";
inline constexpr std::string_view mac_schema =
    R"("type": "string", "pattern": "^[0-9A-Fa-f]{2}(:[0-9A-Fa-f]{2}){5}$")";

/// The key `allow` beside a bind address: a list of address blocks. Default: loopback peers if the socket is
/// bound to loopback; required for any other address.
void read_allow_list(YamlSection& section, Ipv4 bind_address, AllowList& allow, std::string_view meaning);

/// The required key `bind`, and `allow` beside it.
void read_socket(YamlSection& section, Endpoint& bind, AllowList& allow, const TextForm& form,
                 std::string_view bind_meaning, std::string_view allow_meaning);

/// Reports a `bind` that another socket of a list uses, too; port 0 never conflicts.
template <typename Socket>
void report_if_taken(YamlSection& section, const Endpoint& bind, const std::vector<Socket>& others) {
  const auto same = [&](const Socket& other) { return other.bind == bind && bind.port != 0; };
  if (std::any_of(others.begin(), others.end(), same)) {
    section.report("bind", endpoint_text(bind) + " is given twice (expected a socket of its own)");
  }
}

/// The keys `tcp`, `udp`, `pty` (lists) and `baud`. Reports a link without a transport, and transports of one
/// link that conflict.
/// @param folder of the configuration file; links to ptys are relative to it
SerialLinkConfig read_serial_link(YamlSection& section, const std::filesystem::path& folder);

/// The key `lock_to_first`.
/// @param free_again when another client may use the head, in words
void read_lock_to_first(YamlSection& section, bool& lock_to_first, std::string_view free_again);

/// The keys `seed`, `to_client` and `from_client`.
void read_link_faults(YamlSection& section, LinkConfig& link);

}  // namespace sonard::server
