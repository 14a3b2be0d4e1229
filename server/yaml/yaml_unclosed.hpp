// SPDX-License-Identifier: Apache-2.0
// Finds the quote or bracket of a YAML text that is never closed.
#pragma once

#include <optional>
#include <string_view>

#include "server/yaml/config_error.hpp"

namespace sonard::server {

/// For a text that the YAML parser rejected at `last_line`. The parser reports the place where it gave up,
/// many lines after the mistake. A quoted text over several lines is valid YAML. It counts as unclosed if no
/// quote follows, or if text after the next quote shows that this quote was meant to open another text.
/// A quote in the middle of a line ends its text; more text after it is a problem too.
/// @param last_line from 1; later quotes and brackets are ignored
std::optional<ConfigProblem> find_unclosed(std::string_view text, int last_line);

/// A quote whose text runs to the end of the file. yaml-cpp 0.7 accepts that.
std::optional<ConfigProblem> find_endless_quote(std::string_view text);

}  // namespace sonard::server
