// SPDX-License-Identifier: Apache-2.0
// Problems in a configuration file, with their places.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/error/error.hpp"

namespace sonard::server {

/// Place in a text file; both count from 1. Line 0 stands for the file as a whole.
struct SourcePosition {
  int line = 0;
  int column = 0;
};

struct ConfigProblem {
  SourcePosition at;
  std::string key;          ///< "heads[0].link.to_client.loss"; empty if the problem concerns no key
  std::string message;      ///< "... (expected ...)"
  bool of_network = false;  ///< an interface of this machine lacks what the key needs, and may have it later
};

/// A warning about a key; the configuration remains valid.
struct ConfigWarning {
  std::string key;
  std::string message;

  bool operator==(const ConfigWarning&) const = default;
};

using KeyPositions = std::map<std::string, SourcePosition, std::less<>>;

/// Place of a key, or of the nearest mapping around it that the file gives.
SourcePosition nearest_position(const KeyPositions& positions, std::string_view key);

/// "file:line:column: key: message", without the parts that are unknown.
std::string problem_text(const std::filesystem::path& file, const ConfigProblem& problem);
/// problem_text() of each problem.
std::vector<std::string> problem_lines(const std::filesystem::path& file,
                                       const std::vector<ConfigProblem>& problems);

/// All problems of one file, one line each. Its kind is `network` if the file itself is valid and only needs
/// the network to be up.
class ConfigError : public Error {
 public:
  /// @param problems at least one
  ConfigError(const std::filesystem::path& file, std::vector<ConfigProblem> problems);

  /// In the order of the file.
  const std::vector<ConfigProblem>& problems() const { return problems_; }

 private:
  std::vector<ConfigProblem> problems_;
};

}  // namespace sonard::server
