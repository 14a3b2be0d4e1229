// SPDX-License-Identifier: Apache-2.0
#include "server/net/interfaces.hpp"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

Ipv4 ipv4_of(const sockaddr* address) {
  sockaddr_in ipv4{};
  std::memcpy(&ipv4, address, sizeof ipv4);
  return ntohl(ipv4.sin_addr.s_addr);
}

std::optional<InterfaceAddress> first_of(std::string_view interface) {
  const std::vector<InterfaceAddress> entries = interface_addresses();
  const auto found = std::ranges::find(entries, interface, &InterfaceAddress::interface);
  return found == entries.end() ? std::nullopt : std::optional(*found);
}

}  // namespace

std::vector<InterfaceAddress> interface_addresses() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) {
    return {};
  }
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
  std::vector<InterfaceAddress> found;
  for (const ifaddrs* item = list; item != nullptr; item = item->ifa_next) {
    if (item->ifa_addr == nullptr || item->ifa_netmask == nullptr || item->ifa_addr->sa_family != AF_INET ||
        (item->ifa_flags & IFF_UP) == 0) {
      continue;
    }
    found.push_back({item->ifa_name, ipv4_of(item->ifa_addr), ipv4_of(item->ifa_netmask)});
  }
  return found;
}

std::optional<InterfaceAddress> owner_of(Ipv4 address, const std::vector<InterfaceAddress>& interfaces) {
  const auto owns = [address](const InterfaceAddress& entry) {
    return entry.address == address || (is_loopback(address) && is_loopback(entry.address) &&
                                        (entry.address & entry.netmask) == (address & entry.netmask));
  };
  const auto exact =
      std::find_if(interfaces.begin(), interfaces.end(),
                   [address](const InterfaceAddress& entry) { return entry.address == address; });
  const auto found =
      exact != interfaces.end() ? exact : std::find_if(interfaces.begin(), interfaces.end(), owns);
  if (found == interfaces.end()) {
    return std::nullopt;
  }
  return *found;
}

std::optional<Ipv4> parse_own_address(std::string_view text) {
  const std::optional<Ipv4> address = parse_ipv4(text);
  const std::optional<InterfaceAddress> entry = first_of(text);
  return address || !entry ? address : entry->address;
}

std::optional<Ipv4> parse_own_netmask(std::string_view text) {
  const std::optional<Ipv4> netmask = parse_ipv4(text);
  const std::optional<InterfaceAddress> entry = first_of(text);
  return netmask || !entry ? netmask : entry->netmask;
}

}  // namespace sonard::server
