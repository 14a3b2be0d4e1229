// SPDX-License-Identifier: Apache-2.0
// The section that sets how clients reach a serial device: its values. complaints.txt has its errors.
#include "server/yaml/network_section.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

namespace sonard::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct SerialSection : testing::Test {
  YamlFindings findings;

  SerialLinkConfig read(const std::string& text) {
    findings = {};
    YamlSection section(findings, YAML::Load(text), "heads[0].serial");
    return read_serial_link(section, "/etc/sonard");
  }
};

TEST_F(SerialSection, ReadsSeveralTransports) {
  const SerialLinkConfig link = read(
      "tcp:\n"
      "  - {bind: 127.0.0.1:4001}\n"
      "  - {bind: 0.0.0.0:4002, allow: [10.0.0.0/8, 127.0.0.1]}\n"
      "udp: [{bind: 127.0.0.3:4001}]\n"
      "pty: [{link: /tmp/micron}, {link: ports/micron}, {}]\n"
      "baud: 115200\n");
  EXPECT_THAT(findings.problems, IsEmpty());
  ASSERT_EQ(link.tcp.size(), 2U);
  EXPECT_EQ(link.tcp[0].bind, (Endpoint{0x7F000001, 4001}));
  EXPECT_THAT(link.tcp[0].allow, ElementsAre(Cidr{0x7F000000, 8}));
  EXPECT_EQ(link.tcp[1].bind, (Endpoint{0, 4002}));
  EXPECT_THAT(link.tcp[1].allow, ElementsAre(Cidr{0x0A000000, 8}, Cidr{0x7F000001, 32}));
  ASSERT_EQ(link.udp.size(), 1U);
  EXPECT_EQ(link.udp[0].bind, (Endpoint{0x7F000003, 4001}));
  EXPECT_THAT(link.udp[0].allow, ElementsAre(Cidr{0x7F000000, 8}));
  ASSERT_EQ(link.pty.size(), 3U);
  EXPECT_EQ(link.pty[0].link, "/tmp/micron");
  EXPECT_EQ(link.pty[1].link, "/etc/sonard/ports/micron");
  EXPECT_EQ(link.pty[2].link, "");
  EXPECT_EQ(link.baud, 115200);
}

TEST_F(SerialSection, IsAsFastAsItGoesUnlessASpeedIsGiven) {
  EXPECT_EQ(read("pty: [{}]\n").baud, 0);
  EXPECT_THAT(findings.problems, IsEmpty());
}

TEST_F(SerialSection, NamesThePlaceOfAnUnknownKey) {
  read("pty: [{name: /tmp/a}]\n");
  ASSERT_EQ(findings.problems.size(), 1U);
  EXPECT_EQ(findings.problems[0].at.column, 8);
  EXPECT_EQ(findings.problems[0].key, "heads[0].serial.pty[0].name");
  EXPECT_EQ(findings.problems[0].message, "unknown key (expected one of link)");
}

}  // namespace
}  // namespace sonard::server
