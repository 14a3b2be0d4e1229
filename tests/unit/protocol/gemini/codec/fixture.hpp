// SPDX-License-Identifier: Apache-2.0
// Datagrams from tests/data/gemini.
#pragma once

#include "tests/support/messages.hpp"

namespace sonard::gemini::testing {

using sonard::testing::Bytes;

inline Bytes load_fixture(const std::string& name) {
  return sonard::testing::message_bytes("gemini", name);
}

}  // namespace sonard::gemini::testing
