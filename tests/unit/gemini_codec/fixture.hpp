// Datagrams from tests/data/gemini.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sonard::gemini::testing {

using Bytes = std::vector<std::uint8_t>;

/// The bytes of tests/data/gemini/`name`.hex. Throws std::runtime_error when there is no such file or it
/// holds anything but hexadecimal bytes.
Bytes load_fixture(const std::string& name);

/// Names of all fixtures, sorted.
std::vector<std::string> fixture_names();

}  // namespace sonard::gemini::testing
