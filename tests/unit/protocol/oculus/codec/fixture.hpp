// SPDX-License-Identifier: Apache-2.0
// Messages from tests/data/oculus.
#pragma once

#include "protocol/oculus/codec.hpp"
#include "tests/support/messages.hpp"

namespace sonard::oculus::testing {

using sonard::testing::Bytes;

inline Bytes load_fixture(const std::string& name) {
  return sonard::testing::message_bytes("oculus", name);
}

inline constexpr Identity m1200d{7892, 1042};

}  // namespace sonard::oculus::testing
