// SPDX-License-Identifier: Apache-2.0
// The section that sets how clients reach a serial device: valid values and errors.
#include "server/yaml/network_section.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

namespace sonard::server {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct SerialSection : testing::Test {
  YamlFindings findings;

  SerialLinkConfig read(const std::string& text) {
    findings = {};
    YamlSection section(findings, YAML::Load(text), "heads[0].serial");
    return read_serial_link(section, "/etc/sonard");
  }
  /// All errors in the text, as "line:column: key: message".
  std::vector<std::string> complaints(const std::string& text) {
    read(text);
    std::vector<std::string> lines;
    for (const ConfigProblem& problem : findings.problems) {
      lines.push_back(
          fmt::format("{}:{}: {}: {}", problem.at.line, problem.at.column, problem.key, problem.message));
    }
    return lines;
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

TEST_F(SerialSection, RefusesALinkThatNobodyCouldReach) {
  const std::string message =
      "heads[0].serial.tcp: no client could reach the device (expected tcp, udp or pty with at least one "
      "item)";
  EXPECT_THAT(complaints("{baud: 9600}\n"), ElementsAre("1:1: " + message));
  EXPECT_THAT(complaints("tcp: []\n"), ElementsAre("1:6: " + message));
}

TEST_F(SerialSection, NamesThePlaceOfEachMistake) {
  EXPECT_THAT(complaints("tcp: [{}]\n"),
              ElementsAre("1:7: heads[0].serial.tcp[0].bind: missing (expected an address and port such as "
                          "127.0.0.1:4001)"));
  for (const char* bad : {"localhost:4001", "127.0.0.1:70000", "127.0.0.1", "4001"}) {
    EXPECT_THAT(complaints(fmt::format("tcp:\n  - {{bind: {}}}\n", bad)),
                ElementsAre(HasSubstr(fmt::format(
                    "2:12: heads[0].serial.tcp[0].bind: '{}' is not understood (expected an address", bad))));
  }
  EXPECT_THAT(
      complaints("udp: {bind: 127.0.0.1:4001}\n"),
      ElementsAre(HasSubstr("heads[0].serial.udp: is a mapping (expected a list"), HasSubstr("no client")));
  EXPECT_THAT(complaints("udp:\n  - {bind: 192.168.1.5:4001}\n"),
              ElementsAre(HasSubstr("2:5: heads[0].serial.udp[0].allow: missing")));
  EXPECT_THAT(complaints("pty: [{name: /tmp/a}]\n"),
              ElementsAre("1:8: heads[0].serial.pty[0].name: unknown key (expected one of link)"));
  EXPECT_THAT(complaints("pty: [{link: [a]}]\n"),
              ElementsAre(HasSubstr("heads[0].serial.pty[0].link: is a list (expected a text)")));
  EXPECT_THAT(complaints("{pty: [{}], bauds: 9600}\n"), ElementsAre(HasSubstr("did you mean 'baud'?")));
}

TEST_F(SerialSection, RefusesTwoOfOneKind) {
  EXPECT_THAT(
      complaints("tcp:\n  - {bind: 127.0.0.1:4001}\n  - {bind: 127.0.0.1:4001}\n"),
      ElementsAre(
          "3:12: heads[0].serial.tcp[1].bind: 127.0.0.1:4001 is given twice (expected a socket of its "
          "own)"));
  EXPECT_THAT(complaints("pty: [{link: a}, {link: ./a}]\n"),
              ElementsAre(HasSubstr("heads[0].serial.pty[1].link: /etc/sonard/a is given twice")));
  EXPECT_THAT(complaints("{tcp: [{bind: 127.0.0.1:4001}], udp: [{bind: 127.0.0.1:4001}], pty: [{}, {}]}\n"),
              IsEmpty())
      << "TCP and UDP ports are apart, and so are ptys";
}

TEST_F(SerialSection, TakesOnlyASpeedThatALineHas) {
  for (const char* bad : {"0", "299", "4000001", "-9600", "9600.5", "fast", "'9600'"}) {
    EXPECT_THAT(complaints(fmt::format("{{pty: [{{}}], baud: {}}}\n", bad)),
                ElementsAre(HasSubstr("heads[0].serial.baud: is '")))
        << bad;
  }
}

}  // namespace
}  // namespace sonard::server
