// SPDX-License-Identifier: Apache-2.0
// Datagrams from tests/data/gemini.
#pragma once

#include "tests/support/hex_fixture.hpp"

namespace sonard::gemini::testing {

using sonard::testing::Bytes;

inline Bytes load_fixture(const std::string& name) {
  return sonard::testing::load_hex_fixture("gemini", name);
}

inline std::vector<std::string> fixture_names() {
  return sonard::testing::hex_fixture_names("gemini");
}

}  // namespace sonard::gemini::testing
