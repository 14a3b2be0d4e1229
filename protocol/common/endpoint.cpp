// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/endpoint.hpp"

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

}  // namespace sonard
