// SPDX-License-Identifier: Apache-2.0
// Text in lower case.
#pragma once

#include <string>
#include <string_view>

namespace sonard {

/// Other characters than the letters A to Z stay.
std::string lower_case(std::string_view text);

}  // namespace sonard
