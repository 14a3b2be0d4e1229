// SPDX-License-Identifier: Apache-2.0
// Models of Gazebo Fuel, by their address on the network, in the folder where Gazebo keeps what it has
// fetched.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace sonard::render {

/// "https://fuel.gazebosim.org/1.0/OWNER/models/NAME/VERSION/files/REST": all but owner and name may be left
/// out.
struct FuelUri {
  std::string owner;    ///< in lower case, as the cache has it
  std::string name;     ///< likewise
  std::string version;  ///< "" or "tip": the newest
  std::string rest;     ///< a file of the model
};

/// With escapes like %20 undone; nullopt: it is no model of Fuel.
std::optional<FuelUri> parse_fuel_uri(std::string_view uri);

std::string lower_case(std::string_view text);

/// The folder of the model, or its file, in $GZ_FUEL_CACHE_PATH, $IGN_FUEL_CACHE_PATH, ~/.gz/fuel or
/// ~/.ignition/fuel.
/// @throws MissingFile saying where it was looked for and how it comes there
std::filesystem::path resolve_in_fuel_cache(const std::string& uri, const FuelUri& fuel);

}  // namespace sonard::render
