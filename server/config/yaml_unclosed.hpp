// SPDX-License-Identifier: Apache-2.0
// Where a quote or a bracket of a YAML text begins that nothing closes.
#pragma once

#include <optional>
#include <string_view>

#include "server/config/config_error.hpp"

namespace sonard::server {

/// For a text that the YAML parser refused at `last_line`. The parser complains where it gave up, many lines
/// behind the mistake. A quoted text over several lines is valid YAML; it counts as unclosed if no quote
/// follows, or if more text stands behind the one that follows, which then was meant to open another.
/// @param last_line from 1; what begins behind it is no cause
std::optional<ConfigProblem> find_unclosed(std::string_view text, int last_line);

/// A quote that opens a text which runs to the end of the file. yaml-cpp 0.7 takes that for valid.
std::optional<ConfigProblem> find_endless_quote(std::string_view text);

}  // namespace sonard::server
