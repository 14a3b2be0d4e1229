// SPDX-License-Identifier: Apache-2.0
// Any bytes as a configuration.
// Promises: it is read, or each problem is one line of limited length; nothing else is thrown.
#include <cstddef>
#include <cstdint>
#include <string>

#include "server/config/loader.hpp"
#include "server/devices/types/types.hpp"
#include "server/yaml/config_error.hpp"
#include "tests/fuzz/file_in_memory.hpp"
#include "tests/fuzz/require.hpp"

using sonard::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sonard::fuzz::FileInMemory file(".yaml");
  file.hold(data, size);
  try {
    const sonard::server::LoadedConfig loaded = load_config(file.path(), sonard::server::head_types());
    require(!loaded.config.heads.empty(), "a configuration has a head");
  } catch (const sonard::server::ConfigError& error) {
    require(!error.lines().empty() && error.lines().size() <= 1001, "problems are listed, and bounded");
    for (const std::string& line : error.lines()) {
      require(!line.empty() && line.size() < 4096, "a problem is one line");
    }
  }
  return 0;
}
