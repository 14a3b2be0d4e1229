// SPDX-License-Identifier: Apache-2.0
// SIGHUP: the configuration is read again, and the daemon begins anew with the bytes that were checked.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "server/config/config.hpp"

namespace sonard::server {

/// Configurations that the program before this one in the same process, or the parent, has handed on.
struct InheritedConfig {
  std::optional<std::string> text;      ///< stands for the file
  std::optional<std::string> fallback;  ///< what was in use before; the way back if `text` cannot be served
};

/// Called once, before anything else is opened.
InheritedConfig inherit_config();

class Reload {
 public:
  /// @param text of the configuration in use, which outlives this
  Reload(const DaemonConfig& in_use, std::string text);

  /// Reads the file once and checks these bytes: `sonard check --no-network` in a separate process, then
  /// the ports and the recording folder that the configuration in use does not hold. Blocks for as long as
  /// the world takes to load, or until a stop is requested. Any one thread.
  /// @return why the daemon cannot begin anew; nullopt: it can
  std::optional<std::string> check(const std::stop_token& stop);

  /// Replaces the process by a new one with the same command line and the bytes that were checked. Returns
  /// only if an order to end has come meanwhile. @throws std::system_error
  void begin_anew(char** argv) const;

 private:
  const DaemonConfig& in_use_;
  const std::string text_;
  std::string checked_;
};

/// Begins anew with the configuration that was in use before. As Reload::begin_anew().
void go_back_to(const std::string& fallback, char** argv);

}  // namespace sonard::server
