// SPDX-License-Identifier: Apache-2.0
// Who may look and who may change something, by what a request says of itself.
#pragma once

#include <string_view>

#include "server/config/config.hpp"

namespace sonard::server {

/// Whether a Host header names this server by address or as localhost. Any other name could be that of a
/// site whose owner lets it lead here (DNS rebinding), so that its pages would be taken for ours.
bool trusted_host(std::string_view host);

/// Whether a page of this origin may connect: ours, one of the configuration, or no page at all, which has
/// none.
/// @param host the Host header of the same request
bool trusted_origin(std::string_view origin, std::string_view host, const WebConfig& config);

/// Whether a request may change state: it comes from this machine, or brings the token as "Bearer TOKEN".
bool may_change(const Endpoint& peer, std::string_view authorization, const WebConfig& config);

}  // namespace sonard::server
