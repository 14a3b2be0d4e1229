// SPDX-License-Identifier: Apache-2.0
// Makes text from peers and files safe for logs and terminals.
#pragma once

#include <string>
#include <string_view>

namespace sonard {

/// Returns `text` as one line that cannot control a terminal or change the reading order. It escapes control
/// characters ("\n", "\x1b"), bytes that are not UTF-8 ("\xff"), and line separators and direction marks of
/// Unicode ("\u202e"). All other characters, including backslashes, are unchanged.
std::string printable(std::string_view text);

}  // namespace sonard
