// SPDX-License-Identifier: Apache-2.0
// Loads messages as bytes from the hexadecimal files in tests/data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sonard::testing {

using Bytes = std::vector<std::uint8_t>;

/// The bytes of tests/data/`folder`/`name`.hex.
/// @throws std::runtime_error if the file does not exist or holds other text than hexadecimal bytes
Bytes load_hex_fixture(const std::string& folder, const std::string& name);

/// Names of all fixtures in a folder, sorted.
std::vector<std::string> hex_fixture_names(const std::string& folder);

}  // namespace sonard::testing
