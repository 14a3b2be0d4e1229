// SPDX-License-Identifier: Apache-2.0
// Loads configurations that a test writes as text.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/config/loader.hpp"
#include "tests/support/temporary_folder.hpp"

namespace sonard::server {

/// The smallest valid configuration. Text appended with an indent of 6 continues the head's network, with 4
/// the head, with 2 the list of heads, and without an indent the document. The network starts on line 8.
inline const std::string minimal_config =
    "world: {file: world.sdf}\n"
    "poses:\n"
    "  initial: {position_m: [1, 2, 3]}\n"
    "heads:\n"
    "  - name: front\n"
    "    type: gemini_720i\n"
    "    sonar_id: 513\n"
    "    network:\n"
    "      alternate_address: 127.0.0.2\n"
    "      netmask: 255.0.0.0\n";

/// A temporary folder for each test, deleted when the test ends.
class ConfigFolder : public testing::Test {
 protected:
  /// Writes `text` to "config.yaml" and loads it.
  LoadedConfig load(const std::string& text) const;
  /// The warnings of load(), one line each, without the folder.
  std::vector<std::string> warnings(const std::string& text) const;
  /// The errors of load(), one line each, without the folder; empty if it succeeds.
  std::vector<std::string> complaints(const std::string& text) const;

  const test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
};

}  // namespace sonard::server
