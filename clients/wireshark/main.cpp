// SPDX-License-Identifier: Apache-2.0
// Prints one of the field tables of the dissectors:
//   wireshark_fields gemini >clients/wireshark/sonard_gemini_fields.lua
#include <cstdio>
#include <string_view>

#include "clients/wireshark/field_tables.hpp"

int main(int argc, char** argv) {
  const std::string_view device = argc == 2 ? argv[1] : "";
  if (device != "gemini" && device != "micron") {
    std::fputs("Usage: wireshark_fields gemini|micron\n", stderr);
    return 64;
  }
  const std::string lua = device == "gemini" ? sonard::wireshark::gemini_field_tables()
                                             : sonard::wireshark::micron_field_tables();
  std::fputs(lua.c_str(), stdout);
  return 0;
}
