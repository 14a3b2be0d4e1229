// SPDX-License-Identifier: Apache-2.0
// The command line of `sonard render`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/offline/options.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): a library's name
class App;
class Option;
}  // namespace CLI

namespace sonard::server {

class OfflineArguments {
 public:
  /// Declares the options. `app` and this object must live until `app` has parsed.
  explicit OfflineArguments(CLI::App& app);

  const std::filesystem::path& config() const { return config_; }
  /// @throws CLI::ValidationError
  OfflineOptions options() const;

 private:
  void declare_run(CLI::App& app);
  void declare_sonar(CLI::App& app);

  std::filesystem::path config_;
  OfflineOptions options_;
  // As given on the command line.
  std::string axes_ = "enu_flu";
  std::string shard_ = "0/1";
  std::vector<std::string> bodies_;
  bool still_ = false;
  bool never_still_ = false;
};

}  // namespace sonard::server
