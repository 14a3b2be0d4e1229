// SPDX-License-Identifier: Apache-2.0
// SIGHUP: reads the configuration again and restarts the daemon with the checked bytes.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "server/config/config.hpp"

namespace sonard::server {

/// Configurations handed on by the parent, or by the previous program in the same process.
struct InheritedConfig {
  std::optional<std::string> text;      ///< used instead of the file
  std::optional<std::string> fallback;  ///< the previous one, for use if `text` cannot be served
};

/// Reads and removes the inherited configurations. Call it once, before anything else is opened.
InheritedConfig inherit_config();

class Reload {
 public:
  /// @param text of the configuration in use; `in_use` must outlive this object
  Reload(const DaemonConfig& in_use, std::string text);

  /// Reads the file once and checks these bytes. First `sonard check --no-network` runs in a separate
  /// process, then the ports and the recording folder are tried that the configuration in use does not hold.
  /// Blocks until the world is loaded or a stop is requested. Can be called on any one thread.
  /// @return why the daemon cannot restart; nullopt if it can
  std::optional<std::string> check(const std::stop_token& stop);

  /// Replaces the process by a new one with the same command line and the checked bytes. Returns only if
  /// SIGINT or SIGTERM arrived meanwhile. @throws std::system_error
  void begin_anew(char** argv) const;

 private:
  const DaemonConfig& in_use_;
  const std::string text_;
  std::string checked_;
};

/// Restarts with the previous configuration, like Reload::begin_anew().
void go_back_to(const std::string& fallback, char** argv);

}  // namespace sonard::server
