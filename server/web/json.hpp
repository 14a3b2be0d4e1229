// SPDX-License-Identifier: Apache-2.0
// Status and poses as JSON. docs/page.md lists the members.
#pragma once

#include <chrono>

#include <nlohmann/json.hpp>

#include "server/web/status.hpp"

namespace sonard::server {

/// [x, y, z]
nlohmann::json vector_json(const glm::dvec3& v);

/// {"position_m": [x, y, z], "orientation_wxyz": [w, x, y, z]}, in the world (z up).
nlohmann::json placed_json(const render::Pose& pose);

/// The answer to GET /api/status.
nlohmann::json status_json(const DaemonIdentity& identity, const DaemonStatus& status,
                           std::chrono::duration<double> uptime);

/// Text of JSON; bytes that are no UTF-8, as a name from the network may have, are replaced.
std::string text_of(const nlohmann::json& value);

}  // namespace sonard::server
