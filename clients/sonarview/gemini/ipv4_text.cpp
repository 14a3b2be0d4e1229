// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/ipv4_text.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

namespace sonard::client {

std::string ipv4_text(std::uint32_t address) {
  return fmt::format("{}.{}.{}.{}", address >> 24, address >> 16 & 0xFF, address >> 8 & 0xFF, address & 0xFF);
}

std::optional<std::uint32_t> parse_ipv4(const std::string& text) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1) {
    return std::nullopt;
  }
  return ntohl(address.s_addr);
}

}  // namespace sonard::client
