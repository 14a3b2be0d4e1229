// SPDX-License-Identifier: Apache-2.0
// Metrics against the text format of Prometheus 0.0.4 (its page "Exposition formats").
#include "server/web/metrics.hpp"

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

DaemonStatus status_of_two_heads() {
  DaemonStatus status;
  status.engine = "cpu, because the GPU is lost: reset";
  for (const char* name : {"bow", "st\"ern\\\n"}) {
    HeadStatus head;
    head.name = name;
    head.counts.pings.sent = 42;
    head.counts.device = {{.name = "lines_resent", .value = 7},
                          {.name = "unknown_type", .value = 3, .fault = Counter::Fault::of_client}};
    head.latency = std::chrono::milliseconds{20};
    head.since_last_ping = std::chrono::milliseconds{1500};
    status.heads.push_back(head);
  }
  status.inputs.emplace_back().input = "pose stream udp 127.0.0.1:14600";
  status.recording.emplace();
  return status;
}

std::string text() {
  return metrics_text({"demo.yaml", "tank", {}}, status_of_two_heads(), std::chrono::seconds{3});
}

TEST(Metrics, HaveHelpTypeAndValuesOfEachNameTogether) {
  const std::regex sample(
      R"re((sonard_[a-z_]+)(\{[a-z_]+="([^"\\]|\\.)*"(,[a-z_]+="([^"\\]|\\.)*")*\})? [0-9.e+-]+)re");
  std::set<std::string> begun;
  std::string current;
  std::istringstream lines(text());
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with("# HELP ")) {
      current = line.substr(7, line.find(' ', 7) - 7);
      EXPECT_TRUE(begun.insert(current).second) << current << " comes twice";
    } else if (line.starts_with("# TYPE ")) {
      EXPECT_TRUE(line == "# TYPE " + current + " counter" || line == "# TYPE " + current + " gauge") << line;
    } else {
      ASSERT_TRUE(std::regex_match(line, match, sample)) << line;
      EXPECT_EQ(match[1], current) << line;
      EXPECT_EQ(line.find("_total") != std::string::npos,
                text().find("# TYPE " + current + " counter") != std::string::npos);
    }
  }
  EXPECT_TRUE(text().ends_with("\n"));
}

TEST(Metrics, CountThePingsOfEachHead) {
  EXPECT_NE(text().find("sonard_pings_total{head=\"bow\"} 42\n"), std::string::npos);
}

TEST(Metrics, CountTheFaultsOfClientsOnly) {
  EXPECT_NE(text().find("sonard_client_faults_total{head=\"bow\",event=\"unknown_type\"} 3\n"),
            std::string::npos);
  EXPECT_EQ(text().find("sonard_client_faults_total{head=\"bow\",event=\"lines_resent\"}"),
            std::string::npos);
}

TEST(Metrics, EscapeNames) {
  EXPECT_NE(text().find("sonard_pings_total{head=\"st\\\"ern\\\\\\n\"} 42\n"), std::string::npos);
}

TEST(Metrics, AreInSeconds) {
  EXPECT_NE(text().find("sonard_ping_latency_seconds{head=\"bow\"} 0.02\n"), std::string::npos);
}

TEST(Metrics, NameTheEngineInUse) {
  EXPECT_NE(text().find("engine=\"cpu, because the GPU is lost: reset\"} 1\n"), std::string::npos);
}

TEST(Metrics, SayHowOldTheLastPingIsAndWhetherTheDaemonIsReady) {
  EXPECT_NE(text().find("sonard_last_ping_age_seconds{head=\"bow\"} 1.5\n"), std::string::npos);
  EXPECT_NE(text().find("\nsonard_ready 0\n"), std::string::npos) << "no pose is known";
}

}  // namespace
}  // namespace sonard::server
