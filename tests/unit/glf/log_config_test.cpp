// SPDX-License-Identifier: Apache-2.0
// The .cfg of a log (docs/logs.md 1.2).
#include <gtest/gtest.h>

#include "protocol/glf/log_config.hpp"

namespace sonard::glf {
namespace {

TEST(LogConfig, is_the_fixed_text) {
  EXPECT_EQ(config_xml({.app_name = "sonard 1 & <co>",
                        .creation_time_s = 1'479'651'753.25,
                        .close_time_s = 1'479'651'760.0,
                        .device_ids = {1194, 2001}}),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<genesisLog>\n"
            "  <logHeader>\n"
            "    <appName>sonard 1 &amp; &lt;co&gt;</appName>\n"
            "    <fileVersion>1</fileVersion>\n"
            "    <creationTime>1479651753.250</creationTime>\n"
            "    <deviceInfo>Gemini - 1194, Gemini - 2001</deviceInfo>\n"
            "  </logHeader>\n"
            "  <logTerminator>\n"
            "    <closeTime>1479651760.000</closeTime>\n"
            "  </logTerminator>\n"
            "</genesisLog>\n");
}

TEST(LogConfig, times_are_read_where_they_stand) {
  const LogSpan span = read_log_span("<a><logHeader><creationTime>\n 12.5 </creationTime></logHeader></a>");
  EXPECT_EQ(span.creation_time_s, 12.5);
  EXPECT_FALSE(span.close_time_s);
}

TEST(LogConfig, what_is_no_number_is_left_out) {
  for (const char* text : {"", "<closeTime>", "<closeTime></closeTime>", "<closeTime>soon</closeTime>",
                           "<closeTime>1 2</closeTime>", "<closeTime>nan</closeTime>",
                           "<closeTime>1e999</closeTime>", "<closeTime> ", "<closeTime>1,5</closeTime>"}) {
    EXPECT_FALSE(read_log_span(text).close_time_s) << text;
  }
}

}  // namespace
}  // namespace sonard::glf
