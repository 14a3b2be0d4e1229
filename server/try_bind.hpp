// SPDX-License-Identifier: Apache-2.0
// Tests whether a socket can be bound.
#pragma once

#include <optional>
#include <string>

#include "server/config/head_kind.hpp"

namespace sonard::server {

/// Binds the socket for a moment. @return why it cannot be bound; nullopt if it can
std::optional<std::string> obstacle_to_binding(const PlannedSocket& planned);

}  // namespace sonard::server
