// SPDX-License-Identifier: Apache-2.0
// Prints the field table of a dissector:
//   wireshark_fields gemini >clients/wireshark/sonard_gemini_fields.lua
#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>

#include "clients/wireshark/field_tables.hpp"

int main(int argc, char** argv) {
  using sonard::wireshark::FieldTables;
  const auto devices = sonard::wireshark::device_field_tables();
  const std::string_view asked = argc == 2 ? argv[1] : "";
  const auto found = std::ranges::find(devices, asked, &FieldTables::device);
  if (found == devices.end()) {
    std::string names;
    for (const FieldTables& tables : devices) {
      names += (names.empty() ? "" : "|") + std::string{tables.device};
    }
    std::fprintf(stderr, "Usage: wireshark_fields %s\n", names.c_str());
    return 64;
  }
  std::fputs(found->lua().c_str(), stdout);
  return 0;
}
