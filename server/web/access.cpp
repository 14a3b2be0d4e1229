// SPDX-License-Identifier: Apache-2.0
#include "server/web/access.hpp"

#include <algorithm>
#include <string>

#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

/// Takes the same time for a right and a wrong text of the same length.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) {
    return false;
  }
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

}  // namespace

bool trusted_host(std::string_view host) {
  const std::string_view name = host.substr(0, host.find(':'));
  return name == "localhost" || parse_ipv4(name).has_value();
}

bool trusted_origin(std::string_view origin, std::string_view host, const WebConfig& config) {
  if (origin.empty() || std::ranges::find(config.origins, origin) != config.origins.end()) {
    return true;
  }
  constexpr std::string_view scheme = "http://";
  return origin.starts_with(scheme) && origin.substr(scheme.size()) == host;
}

bool may_change(const Endpoint& peer, std::string_view authorization, const WebConfig& config) {
  constexpr std::string_view bearer = "Bearer ";
  if (!config.token.empty() && authorization.starts_with(bearer)) {
    return same_secret(authorization.substr(bearer.size()), config.token);
  }
  return is_loopback(peer.address);
}

}  // namespace sonard::server
