// SPDX-License-Identifier: Apache-2.0
#include "server/net/addresses.hpp"

#include <algorithm>
#include <bit>
#include <charconv>

#include <fmt/core.h>
#include <boost/asio/ip/network_v4.hpp>

namespace sonard::server {

namespace ip = boost::asio::ip;
using boost::system::error_code;

namespace {

/// Splits at the first `mark`: returns the text before it, and `text` keeps the text after it. Without a
/// `mark`, returns everything.
std::string_view take_until(std::string_view& text, char mark) {
  const std::size_t at = text.find(mark);
  const std::string_view head = text.substr(0, at);
  text = at == std::string_view::npos ? std::string_view{} : text.substr(at + 1);
  return head;
}

}  // namespace

std::optional<Ipv4> parse_ipv4(std::string_view text) {
  error_code error;
  const ip::address_v4 address = ip::make_address_v4(text, error);
  return error ? std::nullopt : std::optional<Ipv4>(address.to_uint());
}

std::optional<Cidr> parse_cidr(std::string_view text) {
  if (text.find('/') == std::string_view::npos) {
    const std::optional<Ipv4> address = parse_ipv4(text);
    return address ? std::optional<Cidr>({*address, 32}) : std::nullopt;
  }
  error_code error;
  const ip::network_v4 block = ip::make_network_v4(text, error);
  if (error || block != block.canonical()) {
    return std::nullopt;
  }
  return Cidr{block.network().to_uint(), block.prefix_length()};
}

std::optional<Endpoint> parse_endpoint(std::string_view text) {
  const std::optional<Ipv4> address = parse_ipv4(take_until(text, ':'));
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, port);
  if (!address || error != std::errc{} || stop != end) {
    return std::nullopt;
  }
  return Endpoint{*address, port};
}

std::optional<std::array<std::uint8_t, 6>> parse_mac(std::string_view text) {
  std::array<std::uint8_t, 6> mac{};
  if (std::count(text.begin(), text.end(), ':') != 5) {
    return std::nullopt;
  }
  for (std::uint8_t& octet : mac) {
    const std::string_view digits = take_until(text, ':');
    const char* end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, octet, 16);
    if (digits.size() != 2 || error != std::errc{} || stop != end) {
      return std::nullopt;
    }
  }
  return mac;
}

std::string cidr_text(const Cidr& block) {
  return fmt::format("{}/{}", address_text(block.network), block.prefix_length);
}

Ipv4 netmask_of(int prefix_length) {
  return prefix_length == 0 ? 0 : ~Ipv4{0} << (32 - prefix_length);
}

std::optional<int> prefix_length_of(Ipv4 netmask) {
  const int length = std::countl_one(netmask);
  if (netmask != netmask_of(length)) {
    return std::nullopt;
  }
  return length;
}

bool Cidr::contains(Ipv4 address) const {
  return (address & netmask_of(prefix_length)) == network;
}

bool allows(const AllowList& list, Ipv4 address) {
  return std::any_of(list.begin(), list.end(),
                     [address](const Cidr& block) { return block.contains(address); });
}

}  // namespace sonard::server
