// SPDX-License-Identifier: Apache-2.0
// Escapes in URIs.
#pragma once

#include <string>
#include <string_view>

namespace sonard {

/// Decodes escapes like %20; other text, "%zz" among it, stays.
std::string percent_decoded(std::string_view text);

}  // namespace sonard
