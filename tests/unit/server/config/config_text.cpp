// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/server/config/config_text.hpp"

#include <fstream>

#include "server/devices/types/types.hpp"

namespace sonard::server {
namespace {

std::vector<std::string> without_folder(std::vector<std::string> lines) {
  for (std::string& line : lines) {
    line = line.substr(line.find("config.yaml"));
  }
  return lines;
}

}  // namespace

LoadedConfig ConfigFolder::load(const std::string& text) const {
  std::ofstream(folder_ / "config.yaml", std::ios::binary) << text;
  return load_config(folder_ / "config.yaml", head_types());
}

std::vector<std::string> ConfigFolder::warnings(const std::string& text) const {
  return without_folder(load(text).warning_lines());
}

std::vector<std::string> ConfigFolder::complaints(const std::string& text) const {
  try {
    load(text);
    return {};
  } catch (const ConfigError& error) {
    return without_folder(error.lines());
  }
}

}  // namespace sonard::server
