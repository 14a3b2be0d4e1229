// SPDX-License-Identifier: Apache-2.0
// Field tables of the Wireshark dissectors, as Lua, made from protocol/DEVICE/layout.hpp, so that dissectors
// and codecs agree. The results are checked in beside the dissectors, because Wireshark loads files;
// tests/unit/clients/wireshark compares them with these functions.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace sonard::wireshark {

struct FieldTables {
  std::string_view device;  ///< name in cmake/devices.cmake
  std::string (*lua)();     ///< returns the text of sonard_DEVICE_fields.lua
};

/// The tables of all devices. CMakeLists.txt generates this list. A device NAME needs a file NAME_fields.cpp
/// with `std::string NAME_field_tables()` in this namespace.
std::span<const FieldTables> device_field_tables();

}  // namespace sonard::wireshark
