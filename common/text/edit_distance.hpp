// SPDX-License-Identifier: Apache-2.0
// Compares a mistyped word with the words that it may be meant to be.
#pragma once

#include <cstddef>
#include <string_view>

namespace sonard {

/// Levenshtein distance: number of bytes to insert, delete or replace to make `b` from `a`.
std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace sonard
