// SPDX-License-Identifier: Apache-2.0
// Text of foreign files in messages: it must neither begin a line of its own nor steer a terminal.
#pragma once

#include <string>
#include <string_view>

namespace sonard::render {

/// The text with each control character (C0, DEL, and C1 in UTF-8) as its number: ESC becomes \x1b.
std::string printable(std::string_view text);

}  // namespace sonard::render
