// SPDX-License-Identifier: Apache-2.0
// Frames from tests/data/micron.
#pragma once

#include "tests/support/hex_fixture.hpp"

namespace sonard::micron::testing {

using sonard::testing::Bytes;

inline Bytes load_fixture(const std::string& name) {
  return sonard::testing::load_hex_fixture("micron", name);
}

inline std::vector<std::string> fixture_names() {
  return sonard::testing::hex_fixture_names("micron");
}

}  // namespace sonard::micron::testing
