// SPDX-License-Identifier: Apache-2.0
// Models of Gazebo Fuel, by their network address, in Gazebo's download folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace sonard::render {

/// "https://fuel.gazebosim.org/1.0/OWNER/models/NAME/VERSION/files/REST": only owner and name are required.
struct FuelUri {
  std::string owner;    ///< in lower case, as in the cache
  std::string name;     ///< in lower case
  std::string version;  ///< "" or "tip": the newest version
  std::string rest;     ///< path of a file of the model
};

/// Decodes escapes like %20; nullopt if the URI is not a model of Fuel.
std::optional<FuelUri> parse_fuel_uri(std::string_view uri);

/// The folder of the model, or its file, in $GZ_FUEL_CACHE_PATH, $IGN_FUEL_CACHE_PATH, ~/.gz/fuel or
/// ~/.ignition/fuel.
/// @throws MissingFile with the folders searched and the command that downloads the model
std::filesystem::path resolve_in_fuel_cache(const std::string& uri, const FuelUri& fuel);

}  // namespace sonard::render
