// SPDX-License-Identifier: Apache-2.0
// The error that ends a command: main prints it and exits with the code of its kind.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sonard::server {

/// What cannot be used. Each kind has an exit code (server/daemon/exit_codes.hpp).
enum class ErrorKind {
  configuration,  ///< a value of the configuration, or a world, trajectory or log
  network,        ///< an address or port
  renderer,       ///< the engine
  output,         ///< a file or folder to write to
  usage,          ///< the command line
  internal,       ///< a defect of this program
  exhausted,      ///< descriptors, threads or memory have run out
};

/// what() is one line for people. Subclasses are for callers that handle one sort of error and go on.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind what_fails, const std::string& text, std::string config_key = {},
        std::vector<std::string> more_lines = {})
      : std::runtime_error(text),
        kind(what_fails),
        where(std::move(config_key)),
        more(std::move(more_lines)) {}

  /// what(), then `more`.
  std::vector<std::string> lines() const {
    std::vector<std::string> all{what()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  ErrorKind kind;
  std::string where;  ///< key of the configuration: "heads[0].network.bind"; empty: no key is at fault
  std::vector<std::string> more;  ///< further lines about the same place
};

}  // namespace sonard::server
