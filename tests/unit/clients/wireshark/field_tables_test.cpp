// SPDX-License-Identifier: Apache-2.0
// The tables that Wireshark's dissectors load equal the tables of the codecs, for every device of
// cmake/devices.cmake. tests/logs/wireshark compares their meaning with byte examples.
#include "clients/wireshark/field_tables.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace sonard::wireshark {
namespace {

std::string checked_in(const std::string& name) {
  std::ifstream file{SONARD_SOURCE_DIR "/clients/wireshark/" + name};
  return {std::istreambuf_iterator<char>{file}, {}};
}

TEST(FieldTables, FilesAreUpToDate) {
  for (const FieldTables& tables : device_field_tables()) {
    const std::string device{tables.device};
    const std::string file = "sonard_" + device + "_fields.lua";
    EXPECT_EQ(checked_in(file), tables.lua())
        << "wireshark_fields " << device << " >clients/wireshark/" << file;
  }
}

// If the code that makes a table lacks a name, the table has "unknown" there.
TEST(FieldTables, NameEveryMessage) {
  for (const FieldTables& tables : device_field_tables()) {
    const std::string lua = tables.lua();
    EXPECT_EQ(lua.find("unknown"), std::string::npos) << tables.device;
    for (const std::string part : {"  commands = {\n    [", "  reports = {\n    [", "  messages = {\n    "}) {
      if (tables.device == "sonar3d15" && part.starts_with("  commands")) {
        continue;  // they are HTTP, which Wireshark knows
      }
      if (tables.device == "dvl_a50" && !part.starts_with("  messages")) {
        continue;  // they are text with their names, but for PD4
      }
      EXPECT_NE(lua.find(part), std::string::npos) << tables.device << " has no" << part;
    }
  }
}

TEST(FieldTables, HaveADissectorThatLoadsThem) {
  for (const FieldTables& tables : device_field_tables()) {
    const std::string device{tables.device};
    EXPECT_NE(checked_in("sonard_" + device + ".lua").find("sonard_" + device + "_fields.lua"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace sonard::wireshark
