// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace sonard::render {

/// The settings are invalid for a ping (range <= 0, no beams, beyond GL limits, NaN pose, ...). what() names
/// the value.
struct RequestError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// No usable GL, a lost context, or a failed self test. The process must end, because it would serve zeros.
struct RendererError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace sonard::render
