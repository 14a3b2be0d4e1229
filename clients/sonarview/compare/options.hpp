// SPDX-License-Identifier: Apache-2.0
// What the user asks of `sonarview compare`.
#pragma once

#include <filesystem>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct CompareOptions {
  std::string a;  ///< a source for load_frame()
  std::string b;
  std::filesystem::path json;  ///< file for the result; empty: none
};

/// The options of the subcommand.
class CompareArguments {
 public:
  /// Declares them; `app` and this object then live until it has parsed.
  explicit CompareArguments(CLI::App& app);

  const CompareOptions& options() const { return options_; }

 private:
  CompareOptions options_;
};

}  // namespace sonard::client
