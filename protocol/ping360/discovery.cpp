// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/discovery.hpp"

#include <charconv>
#include <string_view>

#include <fmt/format.h>

namespace sonard::ping360 {
namespace {

constexpr std::size_t longest_datagram = 64;  // longer ones are ignored

/// The text of a datagram without blanks around it; empty if it is too long.
std::string trimmed(std::span<const std::uint8_t> datagram) {
  if (datagram.size() > longest_datagram) {
    return {};
  }
  const std::string text(datagram.begin(), datagram.end());
  constexpr std::string_view blank{" \t\r\n\0", 5};
  const auto begin = text.find_first_not_of(blank);
  return begin == std::string::npos ? std::string()
                                    : text.substr(begin, text.find_last_not_of(blank) + 1 - begin);
}

}  // namespace

bool is_discovery(std::span<const std::uint8_t> datagram) {
  return trimmed(datagram) == "Discovery";
}

std::string discovery_reply(const std::array<std::uint8_t, 6>& mac, Ipv4 address) {
  return fmt::format(
      "SONAR PING360\r\nBlue Robotics\r\nMAC Address:- {:02X}-{:02X}-{:02X}-{:02X}-{:02X}-{:02X}\r\n"
      "IP Address:- {:03}.{:03}.{:03}.{:03}\r\n",
      mac[0], mac[1], mac[2], mac[3], mac[4], mac[5], address >> 24, address >> 16 & 0xFFU,
      address >> 8 & 0xFFU, address & 0xFFU);
}

std::optional<Ipv4> set_ip(std::span<const std::uint8_t> datagram) {
  constexpr std::string_view order = "SetSS1IP ";
  const std::string text = trimmed(datagram);
  if (!text.starts_with(order)) {
    return std::nullopt;
  }
  const char* at = text.data() + order.size();
  const char* const end = text.data() + text.size();
  Ipv4 address = 0;
  for (int group = 0; group < 4; ++group) {
    std::uint8_t octet = 0;
    const auto [next, error] = std::from_chars(at, end, octet);
    const bool last = group == 3;
    if (error != std::errc{} || (last ? next != end : next == end || *next != '.')) {
      return std::nullopt;
    }
    address = address << 8 | octet;
    at = last ? next : next + 1;
  }
  return address;
}

}  // namespace sonard::ping360
