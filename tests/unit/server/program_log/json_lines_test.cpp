// SPDX-License-Identifier: Apache-2.0
// The format is described in docs/deploy.md.
#include "server/program_log/json_lines.hpp"

#include <chrono>
#include <string>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using Json = nlohmann::ordered_json;

std::string line_of(spdlog::level::level_enum level, const std::string& text) {
  // 951827696.042 s after 1970 is 2000-02-29 12:34:56.042 UTC: 11016 days of 86400 s, and 45296 s.
  const spdlog::log_clock::time_point time{std::chrono::milliseconds{951'827'696'042}};
  spdlog::memory_buf_t line;
  JsonLines().format({time, {}, "sonard", level, text}, line);
  return {line.data(), line.size()};
}

TEST(JsonLines, AreOneObjectALine) {
  EXPECT_EQ(line_of(spdlog::level::info, "head=bow: pings_per_s=5.0 render_ms=38.15"),
            R"({"time":"2000-02-29T12:34:56.042Z","level":"info","head":"bow",)"
            R"("message":"pings_per_s=5.0 render_ms=38.15","keys":{"pings_per_s":5.0,"render_ms":38.15}})"
            "\n");
}

TEST(JsonLines, EscapeWhatALineHolds) {
  const std::string line = line_of(spdlog::level::warn, "recording: \"a\tb\"\n\xff");
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  const Json json = Json::parse(line);
  EXPECT_EQ(json["level"], "warning");
  EXPECT_EQ(json["area"], "recording");
  EXPECT_EQ(json["message"], "recording: \"a\tb\"\n\xEF\xBF\xBD");
}

TEST(JsonLines, NameTheHeadOrTheArea) {
  EXPECT_EQ(members_of("head=bow: no pose").dump(), R"({"head":"bow","message":"no pose","keys":{}})");
  EXPECT_EQ(members_of("engine auto: cpu is taken")["area"], "engine");
  EXPECT_EQ(members_of("pose stream udp 127.0.0.1:14600: datagram dropped")["area"], "pose");
  EXPECT_EQ(members_of("web: http://127.0.0.1:8014")["area"], "web");
  EXPECT_EQ(members_of("signal 15")["area"], "sonard");
}

TEST(JsonLines, HaveKeysWithTheirValues) {
  const Json keys = members_of(
      "sonard ready heads=2 world=tank engine=\"cpu, Embree 3.13.5\" position_m=[1.0, 2.0, -3.0] "
      "to=10.0.0.1:52900, "
      "id=0x10 drops=18446744073709551615")["keys"];
  EXPECT_EQ(keys["heads"], 2);
  EXPECT_TRUE(keys["heads"].is_number_integer());
  EXPECT_EQ(keys["world"], "tank");
  EXPECT_EQ(keys["engine"], "cpu, Embree 3.13.5");
  EXPECT_EQ(keys["position_m"], "[1.0, 2.0, -3.0]");
  EXPECT_EQ(keys["to"], "10.0.0.1:52900");
  EXPECT_EQ(keys["id"], "0x10");
  EXPECT_DOUBLE_EQ(keys["drops"].get<double>(), 18446744073709551615.0);
}

}  // namespace
}  // namespace sonard::server
