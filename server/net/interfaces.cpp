// SPDX-License-Identifier: Apache-2.0
#include "server/net/interfaces.hpp"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

Ipv4 ipv4_of(const sockaddr* address) {
  sockaddr_in ipv4{};
  std::memcpy(&ipv4, address, sizeof ipv4);
  return ntohl(ipv4.sin_addr.s_addr);
}

/// Names of all interfaces, with or without an address.
std::vector<std::string> interface_names() {
  const std::unique_ptr<struct if_nameindex, decltype(&if_freenameindex)> list(if_nameindex(),
                                                                               &if_freenameindex);
  std::vector<std::string> names;
  for (const struct if_nameindex* item = list.get(); item != nullptr && item->if_index != 0; ++item) {
    names.emplace_back(item->if_name);
  }
  return names;
}

bool is_up(const std::string& interface) {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) {
    return true;  // unknown
  }
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
  for (const ifaddrs* item = list; item != nullptr; item = item->ifa_next) {
    if (interface == item->ifa_name) {
      return (item->ifa_flags & IFF_UP) != 0;
    }
  }
  return false;
}

/// True if an interface could have this name. Only digits and dots are an address, even if an invalid one.
bool may_be_a_name(std::string_view text) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.'; };
  return text.size() < IFNAMSIZ && std::ranges::all_of(text, fits) &&
         std::ranges::any_of(text, [](unsigned char c) { return std::isalpha(c) != 0; });
}

std::optional<OwnAddress> address_of_interface(std::string_view text) {
  if (!may_be_a_name(text)) {
    return std::nullopt;
  }
  const std::vector<InterfaceAddress> entries = interface_addresses();
  const auto found = std::ranges::find(entries, text, &InterfaceAddress::interface);
  OwnAddress own{.interface = std::string(text)};
  if (found != entries.end()) {
    own.address = found->address;
    own.netmask = found->netmask;
    return own;
  }
  const std::vector<std::string> names = interface_names();
  if (std::ranges::count(names, text) == 0) {
    own.trouble =
        fmt::format("there is no interface '{}' (yet); this machine has {}", text, fmt::join(names, ", "));
  } else {
    own.trouble =
        fmt::format("{} has no IPv4 address (yet){}", text, is_up(own.interface) ? "" : ": it is down");
  }
  return own;
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

std::optional<OwnAddress> parse_own_address(std::string_view text) {
  const std::optional<Ipv4> address = parse_ipv4(text);
  return address ? OwnAddress{.address = *address} : address_of_interface(text);
}

std::optional<OwnAddress> parse_own_netmask(std::string_view text) {
  const std::optional<Ipv4> netmask = parse_ipv4(text);
  return netmask ? OwnAddress{.netmask = *netmask} : address_of_interface(text);
}

std::optional<InterfaceAddress> followed(const std::string& interface, const std::string& netmask_interface,
                                         const InterfaceAddress& current,
                                         const std::vector<InterfaceAddress>& now) {
  // The entry of an interface that has `address`, or its first.
  const auto entry_of = [&](const std::string& name, Ipv4 address) -> const InterfaceAddress* {
    const InterfaceAddress* first = nullptr;
    for (const InterfaceAddress& entry : now) {
      if (!name.empty() && entry.interface == name) {
        if (entry.address == address) {
          return &entry;
        }
        first = first == nullptr ? &entry : first;
      }
    }
    return first;
  };
  InterfaceAddress next = current;
  if (const InterfaceAddress* const entry = entry_of(interface, current.address)) {
    next.address = entry->address;
  }
  if (const InterfaceAddress* const entry = entry_of(netmask_interface, next.address)) {
    next.netmask = entry->netmask;
  }
  if (next.address == current.address && next.netmask == current.netmask) {
    return std::nullopt;
  }
  next.interface = interface.empty() ? netmask_interface : interface;
  return next;
}

std::string followed_text(const InterfaceAddress& before, const InterfaceAddress& after) {
  const std::string netmask = after.netmask == before.netmask
                                  ? ""
                                  : fmt::format("its netmask is {} now", address_text(after.netmask));
  if (after.address == before.address) {
    return fmt::format("{}: {}", after.interface, netmask);
  }
  return fmt::format("{}: its address is {} now{}{}", after.interface, address_text(after.address),
                     netmask.empty() ? "" : ", ", netmask);
}

OwnAddresses::News OwnAddresses::look(const std::vector<Ipv4>& own,
                                      const std::vector<InterfaceAddress>& now) {
  News news;
  if (now.empty()) {
    return news;
  }
  std::erase_if(gone_, [&](Ipv4 address) { return std::ranges::count(own, address) == 0; });
  for (const Ipv4 address : std::set<Ipv4>(own.begin(), own.end())) {
    if (address != 0 && owner_of(address, now)) {
      here_.insert(address);
      if (gone_.erase(address) > 0) {
        news.back.push_back(address);
      }
    } else if (here_.contains(address) && gone_.insert(address).second) {
      news.gone.push_back(address);
    }
  }
  return news;
}

}  // namespace sonard::server
