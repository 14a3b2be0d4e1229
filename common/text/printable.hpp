// SPDX-License-Identifier: Apache-2.0
// Text of peers and files, made safe for a log and for a terminal.
#pragma once

#include <string>
#include <string_view>

namespace sonard {

/// The same text in one line, in which nothing commands a terminal or changes the order of what is read:
/// control characters ("\n", "\x1b"), bytes that are no UTF-8 ("\xff"), and separators of lines and marks of
/// direction of Unicode ("\u202e") are written as escapes. Other characters, a backslash too, stay.
std::string printable(std::string_view text);

}  // namespace sonard
