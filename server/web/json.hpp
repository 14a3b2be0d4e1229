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

/// The answer to GET /api/status.
nlohmann::json status_json(const DaemonIdentity& identity, const DaemonStatus& status,
                           std::chrono::duration<double> uptime);

/// Age of the newest pose of any input; nullopt: none came.
std::optional<std::chrono::nanoseconds> age_of_poses(const DaemonStatus& status);

/// Why a client that asks now gets no picture, one sentence each; empty: the daemon is ready.
std::vector<std::string> why_not_ready(const DaemonStatus& status);

/// The answer to GET /ready (docs/page.md); 503 goes with "ready": false.
nlohmann::json readiness_json(const DaemonStatus& status);

/// JSON that a peer sent, to be looked at by code that calls itself for each level: discarded if it is none,
/// or nested more deeply than any message that is served.
nlohmann::json json_of_peer(std::string_view text);

/// Text of JSON; bytes that are no UTF-8, as a name from the network may have, are replaced.
std::string text_of(const nlohmann::json& value);

}  // namespace sonard::server
