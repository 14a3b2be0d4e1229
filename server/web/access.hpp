// SPDX-License-Identifier: Apache-2.0
// Access control of the page, based on the peer and the headers of a request.
#pragma once

#include <string_view>

#include "server/web/web_config.hpp"

namespace sonard::server {

/// True if a Host header is this server's IP address or localhost. Any other name could be of a site whose
/// owner points it here (DNS rebinding), so that the site's pages would count as ours.
bool trusted_host(std::string_view host);

/// True if a page of this origin may connect: the server's own page, an origin in the configuration, or a
/// client without an origin, which is not a page.
/// @param host the Host header of the same request
bool trusted_origin(std::string_view origin, std::string_view host, const WebConfig& config);

/// True if a request may change state: it comes from this machine, or has the token as "Bearer TOKEN".
bool may_change(const Endpoint& peer, std::string_view authorization, const WebConfig& config);

}  // namespace sonard::server
