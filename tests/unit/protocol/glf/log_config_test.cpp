// SPDX-License-Identifier: Apache-2.0
// The .cfg of a log (protocol/glf/README.md 1.2).
#include <gtest/gtest.h>

#include "protocol/glf/log_config.hpp"

namespace sonard::glf {
namespace {

TEST(LogConfig, IsTheFixedText) {
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

}  // namespace
}  // namespace sonard::glf
