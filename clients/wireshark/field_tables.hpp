// SPDX-License-Identifier: Apache-2.0
// The field tables of the dissectors for Wireshark, as Lua, made from protocol/gemini/layout.hpp and
// protocol/micron/layout.hpp: what a capture shows is where the codecs have it. The results are checked in
// beside the dissectors, for Wireshark loads files; tests/unit/wireshark_fields holds them to these
// functions.
#pragma once

#include <string>

namespace sonard::wireshark {

/// sonard_gemini_fields.lua and sonard_micron_fields.lua.
std::string gemini_field_tables();
std::string micron_field_tables();

}  // namespace sonard::wireshark
