// SPDX-License-Identifier: Apache-2.0
#include "server/yaml/status_section.hpp"

#include <optional>

#include <fmt/format.h>

namespace sonard::server {
namespace {

constexpr TextForm addresses_form{address_form.expected, "addresses", address_schema};

void report_trouble(YamlSection& section, std::string_view key, const OwnAddress& own) {
  if (!own.trouble.empty()) {
    section.report_network(
        key, fmt::format("{} (expected an interface with an address, or the address itself)", own.trouble));
  }
}

}  // namespace

std::string read_own_address(YamlSection& section, std::string_view key, Ipv4& address,
                             std::string_view meaning) {
  OwnAddress own{.address = address};
  section.parsed(key, own, &parse_own_address, own_address_form, meaning);
  report_trouble(section, key, own);
  address = own.address;
  return own.interface;
}

std::string read_own_netmask(YamlSection& section, std::string_view key, Ipv4& netmask,
                             std::string_view meaning) {
  OwnAddress own{.netmask = netmask};
  section.parsed(key, own, &parse_own_netmask, netmask_form, meaning);
  report_trouble(section, key, own);
  netmask = own.netmask;
  return own.interface;
}

void check_host_address(YamlSection& section, std::string_view key, Ipv4 address) {
  if (address == 0 || is_multicast(address) || address == 0xFFFFFFFF) {
    section.report(key, fmt::format("{} is not the address of one host (expected {})", address_text(address),
                                    address_form.expected));
  }
}

void check_inside_network(YamlSection& section, std::string_view address_key, Ipv4 address, Ipv4 netmask) {
  const std::optional<int> prefix = prefix_length_of(netmask);
  if (!prefix || *prefix == 0) {
    section.report("netmask",
                   fmt::format("{} is not a netmask (expected leading ones only, such as 255.255.255.0)",
                               address_text(netmask)));
    return;
  }
  const Ipv4 host = address & ~netmask;
  if (*prefix <= 30 && (host == 0 || host == ~netmask)) {
    section.report(
        address_key,
        fmt::format("{} is the {} address of its network (expected the address of one host under "
                    "mask {})",
                    address_text(address), host == 0 ? "first" : "broadcast", address_text(netmask)));
  }
}

void read_status_destination(YamlSection& section, std::string_view address_key, Ipv4 netmask,
                             StatusDestination& status) {
  using Mode = StatusDestination::Mode;
  const std::string meaning = fmt::format(
      "destination of the status packets: `limited_broadcast` is 255.255.255.255, as on the device; "
      "`directed_broadcast` is the broadcast address of `{}` under `netmask`; a list names the hosts",
      address_key);
  if (!section.is_list("status")) {
    section.choice(
        "status", status.mode,
        {{"limited_broadcast", Mode::limited_broadcast}, {"directed_broadcast", Mode::directed_broadcast}},
        meaning);
  }
  if (section.is_list("status") || section.describing()) {
    status.mode = Mode::unicast;
    section.parsed_list("status", status.hosts, &parse_ipv4, addresses_form, "",
                        "no host is listed (expected at least one address)");
    for (const Ipv4 host : status.hosts) {
      check_host_address(section, "status", host);
    }
  }
  const std::optional<int> prefix = prefix_length_of(netmask);
  if (status.mode == Mode::directed_broadcast && prefix && *prefix > 30) {
    section.report("status",
                   fmt::format("mask {} leaves no broadcast address (expected limited_broadcast or a list)",
                               address_text(netmask)));
  }
}

void warn_of_status_without_access(YamlSection& section, const StatusDestination& status,
                                   const AllowList& allow) {
  for (const Ipv4 host : status.hosts) {
    if (!allow.empty() && !allows(allow, host)) {
      section.warn("status", fmt::format("{} receives status packets but is not in `allow`, so its commands "
                                         "are dropped (add it to `allow`)",
                                         address_text(host)));
    }
  }
}

}  // namespace sonard::server
