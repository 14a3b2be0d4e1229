// SPDX-License-Identifier: Apache-2.0
// Frames from tests/data/micron.
#pragma once

#include "tests/support/messages.hpp"

namespace sonard::micron::testing {

using sonard::testing::Bytes;

inline Bytes load_fixture(const std::string& name) {
  return sonard::testing::message_bytes("micron", name);
}

inline std::vector<std::string> fixture_names() {
  return sonard::testing::message_names("micron");
}

}  // namespace sonard::micron::testing
