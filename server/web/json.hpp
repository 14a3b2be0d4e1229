// SPDX-License-Identifier: Apache-2.0
// Status and poses as JSON. docs/page.md lists the members.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/web/status.hpp"

namespace sonard::server {

/// [x, y, z]
nlohmann::json vector_json(const glm::dvec3& v);

/// {"position_m": [x, y, z], "orientation_wxyz": [w, x, y, z]}, in the world (z up).
nlohmann::json placed_json(const render::Pose& pose);

/// The response to GET /api/status.
nlohmann::json status_json(const DaemonIdentity& identity, const DaemonStatus& status,
                           std::chrono::duration<double> uptime);

/// Age of the newest pose of any input; nullopt: no pose has arrived.
std::optional<std::chrono::nanoseconds> age_of_poses(const DaemonStatus& status);

/// Why a client that connects now gets no picture, one sentence each; empty: the daemon is ready.
std::vector<std::string> why_not_ready(const DaemonStatus& status);

/// The response to GET /ready (docs/page.md); "ready": false needs status 503.
nlohmann::json readiness_json(const DaemonStatus& status);

/// Parses JSON from a peer for recursive code: returns a discarded value if it is invalid, or nested more
/// deeply than any served message.
nlohmann::json json_of_peer(std::string_view text);

/// Serialises JSON; bytes that are not UTF-8, as in a name from the network, are replaced.
std::string text_of(const nlohmann::json& value);

}  // namespace sonard::server
