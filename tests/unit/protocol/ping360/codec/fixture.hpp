// SPDX-License-Identifier: Apache-2.0
// Frames from tests/data/ping360.
#pragma once

#include "tests/support/hex_fixture.hpp"

namespace sonard::ping360::testing {

using sonard::testing::Bytes;

inline Bytes load_fixture(const std::string& name) {
  return sonard::testing::load_hex_fixture("ping360", name);
}

inline std::vector<std::string> fixture_names() {
  return sonard::testing::hex_fixture_names("ping360");
}

}  // namespace sonard::ping360::testing
