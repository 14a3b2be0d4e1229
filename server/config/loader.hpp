// SPDX-License-Identifier: Apache-2.0
// From a YAML file to a DaemonConfig. docs/configuration.md lists the keys.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/config/config.hpp"
#include "server/yaml/config_error.hpp"
#include "server/yaml/key_reference.hpp"

namespace sonard::server {

/// A configuration, and the places of its values in the file.
struct LoadedConfig {
  DaemonConfig config;
  /// Place of the value of every key that the file gives; "heads[0].network.bind" is the form of a key.
  KeyPositions positions;
  std::vector<ConfigProblem> warnings;

  /// The warnings with place and key, one line each.
  std::vector<std::string> warning_lines() const { return problem_lines(config.file, warnings); }

  /// A problem that was found only when a key's value was used (a missing mesh, an address in use), in one
  /// line. Its place is the key, or the nearest mapping around it in the file.
  std::string problem_with(std::string_view key, const std::string& message) const;
  /// As problem_with(), but as data.
  ConfigProblem problem_at(std::string_view key, const std::string& message) const;
};

/// Reads and checks a configuration: loads no world and opens no socket. Relative paths are resolved against
/// the configuration's folder.
/// @param types the permitted types of heads, from server/devices/types, on which this room must not depend
/// @throws ConfigError with every problem of the file.
LoadedConfig load_config(const std::filesystem::path& file, std::span<const HeadType* const> types);

/// Bytes of a configuration file. @throws ConfigError
std::string read_config(const std::filesystem::path& file);
/// The configuration in bytes that were read before.
/// @param file for messages and relative paths; not read
LoadedConfig load_config(const std::filesystem::path& file, const std::string& text,
                         std::span<const HeadType* const> types);

/// All keys of a configuration whose heads are of one type: for the schema and docs/configuration.md.
std::vector<KeyReference> describe_config(const HeadType& type);

}  // namespace sonard::server
