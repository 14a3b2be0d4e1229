// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/endpoint.hpp"

#include <charconv>
#include <system_error>

namespace sonard {

std::string address_text(Ipv4 address) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) {
    text += std::to_string(address >> shift & 0xFFU);
    text += shift > 0 ? "." : "";
  }
  return text;
}

std::string endpoint_text(const Endpoint& endpoint) {
  return address_text(endpoint.address) + ":" + std::to_string(endpoint.port);
}

std::optional<HostAndPort> parse_host_and_port(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) {
    return std::nullopt;
  }
  std::uint16_t port = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data() + colon + 1, end, port);
  if (error != std::errc() || rest != end || port == 0) {
    return std::nullopt;
  }
  return HostAndPort{text.substr(0, colon), port};
}

}  // namespace sonard
