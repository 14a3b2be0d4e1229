// SPDX-License-Identifier: Apache-2.0
// The tables that Wireshark's dissectors load are those of the codecs. What they mean on the wire is held to
// byte examples by tests/logs/wireshark.
#include "clients/wireshark/field_tables.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace sonard::wireshark {
namespace {

std::string checked_in(const std::string& name) {
  std::ifstream file{std::string{SONARD_SOURCE_DIR} + "/clients/wireshark/" + name};
  return {std::istreambuf_iterator<char>{file}, {}};
}

TEST(FieldTables, files_are_up_to_date) {
  EXPECT_EQ(checked_in("sonard_gemini_fields.lua"), gemini_field_tables())
      << "wireshark_fields gemini >clients/wireshark/sonard_gemini_fields.lua";
  EXPECT_EQ(checked_in("sonard_micron_fields.lua"), micron_field_tables())
      << "wireshark_fields micron >clients/wireshark/sonard_micron_fields.lua";
}

// docs/protocols/gemini.md 6.2, 3.5; docs/protocols/micron.md 6.3.
TEST(FieldTables, hold_fields_of_the_documents) {
  EXPECT_NE(gemini_field_tables().find("{ 22, 2, \"end_range\" }"), std::string::npos);
  EXPECT_NE(gemini_field_tables().find("[48] = \"retry_request\""), std::string::npos);
  EXPECT_NE(micron_field_tables().find("{ 40, 2, \"bearing\" }"), std::string::npos);
}

}  // namespace
}  // namespace sonard::wireshark
