// SPDX-License-Identifier: Apache-2.0
// The options of `sonarview compare`.
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
  std::filesystem::path json;  ///< file for the result; empty: not written
};

/// Declares and reads the options of the subcommand.
class CompareArguments {
 public:
  /// Declares the options. `app` and this object must live until `app` has parsed.
  explicit CompareArguments(CLI::App& app);

  const CompareOptions& options() const { return options_; }

 private:
  CompareOptions options_;
};

}  // namespace sonard::client
