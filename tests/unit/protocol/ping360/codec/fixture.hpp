// SPDX-License-Identifier: Apache-2.0
// Frames from tests/data/ping360.
#pragma once

#include "tests/support/messages.hpp"

namespace sonard::ping360::testing {

using sonard::testing::Bytes;

inline Bytes load_fixture(const std::string& name) {
  return sonard::testing::message_bytes("ping360", name);
}

inline std::vector<std::string> fixture_names() {
  return sonard::testing::message_names("ping360");
}

}  // namespace sonard::ping360::testing
