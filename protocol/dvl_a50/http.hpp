// SPDX-License-Identifier: Apache-2.0
// The part of the device's web page that vehicle software reads (8).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace sonard::dvl_a50 {

inline constexpr std::size_t most_request_bytes = 8192;

/// The path of a GET request whose header is complete; empty: another method. nullopt: not complete.
std::optional<std::string> requested_path(std::string_view request);
/// A response that closes the connection.
std::string http_response(std::string_view status, std::string_view content_type, std::string_view body);

}  // namespace sonard::dvl_a50
