// SPDX-License-Identifier: Apache-2.0
// JSON messages of the device (2). Texts are without the end of the line.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "protocol/dvl_a50/json.hpp"
#include "protocol/dvl_a50/messages.hpp"
#include "protocol/dvl_a50/release.hpp"

namespace sonard::dvl_a50 {

std::string encode(const Velocity& report, std::string_view format);
std::string encode(const Position& report, std::string_view format);

/// The answer to a command.
struct Response {
  std::string error;            ///< empty: success
  std::string result = "null";  ///< JSON
};
std::string encode(const Response& response, std::string_view command, std::string_view format);

/// The result of get_config: the settings that the release knows.
std::string encode(const Settings& settings, Release release);
/// Applies the parameters of set_config. On an error `settings` are unchanged.
/// @return the name of a member that is unknown or has a wrong value
std::optional<std::string> apply(const Json::Members& parameters, Release release, Settings& settings);
/// Whether the settings are in range and the release knows the range mode: the name of the first that is not.
std::optional<std::string> wrong_setting(const Settings& settings, Release release);

/// nullopt: another message, or members are missing or have other types.
std::optional<Velocity> decode_velocity(const Json& message);
std::optional<Position> decode_position(const Json& message);

}  // namespace sonard::dvl_a50
