// SPDX-License-Identifier: Apache-2.0
// The field tables of the dissectors for Wireshark, as Lua, made from protocol/DEVICE/layout.hpp: what a
// capture shows is where the codecs have it. The results are checked in beside the dissectors, for Wireshark
// loads files; tests/unit/clients/wireshark holds them to these functions.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace sonard::wireshark {

struct FieldTables {
  std::string_view device;  ///< as cmake/devices.cmake names it
  std::string (*lua)();     ///< makes sonard_DEVICE_fields.lua
};

/// Of all devices. The list is written by CMakeLists.txt, which asks of a device NAME for NAME_fields.cpp
/// with `std::string NAME_field_tables()` in this namespace.
std::span<const FieldTables> device_field_tables();

}  // namespace sonard::wireshark
