// SPDX-License-Identifier: Apache-2.0
// The HTTP interface: what it reads, sets and refuses, by release (acceptance 2).
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "protocol/sonar3d15/utc_text.hpp"
#include "tests/unit/protocol/sonar3d15/device/bench.hpp"

namespace sonard::sonar3d15::testing {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

DeviceConfig of_release(int major, int minor, int patch) {
  DeviceConfig config = small();
  config.release = {major, minor, patch};
  return config;
}

TEST(Controls, AboutHasTheTypesThatClientsCheck) {
  Bench bench;
  const json about = json::parse(bench.get("about"));
  for (const char* text : {"chipid", "product_name", "variant", "version", "version_short"}) {
    EXPECT_TRUE(about.at(text).is_string()) << text;
  }
  EXPECT_TRUE(about.at("hardware_revision").is_number_integer());
  EXPECT_EQ(about.at("product_id"), 21045);
  EXPECT_EQ(about.at("is_ready"), true);
  EXPECT_EQ(about.at("product_name"), "Sonar 3D-15");
  EXPECT_EQ(about.at("version_short"), "1.8.0");
  EXPECT_EQ(json::parse(bench.get("/api/v1/about")), about);
}

TEST(Controls, AValueReadsBackAsItWasSet) {
  Bench bench;
  const std::pair<const char*, std::vector<const char*>> values[] = {
      {"acoustics/enabled", {"true", "false"}},
      {"acoustics/mode", {R"("high-frequency")", R"("low-frequency")"}},
      {"acoustics/range", {R"({"max":3.0,"min":2.0})", R"({"max":16,"min":0})"}},
      {"acoustics/salinity", {R"("fresh")", R"("salt")"}},
      {"acoustics/speed_of_sound", {"1442.0", "1500", "0"}},
      {"output/imu-batch/enabled", {"true", "false"}},
      {"time/ntp", {R"({"ntp_address":"10.0.0.1"})", R"({"ntp_address":"auto"})"}},
      {"udp",
       {R"({"mode":"unicast","unicast_destination_ip":"192.168.2.1","unicast_destination_port":4747})",
        R"({"mode":"disabled","unicast_destination_ip":"","unicast_destination_port":0})",
        R"({"mode":"multicast","unicast_destination_ip":"","unicast_destination_port":0})"}}};
  for (const auto& [path, bodies] : values) {
    const std::string before = bench.get(path);
    for (const char* body : bodies) {
      EXPECT_EQ(bench.post(path, body), 204) << path << " " << body;
      EXPECT_EQ(bench.get(path), body);
    }
    EXPECT_EQ(bench.post(path, before), 204) << path << " " << before;
  }
}

TEST(Controls, AWrongTypeOrValueChangesNothing) {
  Bench bench;
  const std::pair<const char*, std::vector<const char*>> wrong[] = {
      {"acoustics/enabled", {"\"enable\"", "1", "", "tru", "null", "[true]", "true false"}},
      {"acoustics/mode", {"\"fast\"", "1", "{}"}},
      {"acoustics/range",
       {"3", R"({"min":2.0})", R"({"min":3,"max":2})", R"({"min":2,"max":2})", R"({"min":-1,"max":2})",
        R"({"min":0,"max":17})", R"({"min":"0","max":2})", R"({"min":0,"max":1e999})"}},
      {"acoustics/salinity", {"\"brackish\"", "true"}},
      {"acoustics/speed_of_sound", {"\"1500\"", "999", "2001", "-1", "true", "null"}},
      {"output/imu-batch/enabled", {"\"true\"", "0"}},
      {"time/manual", {R"("2026-01-01T00:00:00Z")", R"({"now":"yesterday"})", R"({"now":0})"}},
      {"time/ntp", {"\"auto\"", R"({"ntp_address":""})", R"({"ntp_address":5})"}},
      {"time/ntp/force-sync", {"{}", "5", R"({"timeout_seconds":"5"})"}},
      {"udp",
       {"\"disable\"", R"({"mode":"disable"})", R"({"mode":"unicast"})",
        R"({"mode":"unicast","unicast_destination_ip":"10.0.0.256","unicast_destination_port":1})",
        R"({"mode":"unicast","unicast_destination_ip":"10.0.0","unicast_destination_port":1})",
        R"({"mode":"unicast","unicast_destination_ip":"10.0.0.1 ","unicast_destination_port":1})",
        R"({"mode":"unicast","unicast_destination_ip":"10.0.0.1","unicast_destination_port":0})",
        R"({"mode":"unicast","unicast_destination_ip":"10.0.0.1","unicast_destination_port":65536})",
        R"({"mode":"unicast","unicast_destination_ip":"10.0.0.1","unicast_destination_port":1.5})",
        R"({"mode":"multicast","unicast_destination_ip":5})"}}};
  for (const auto& [path, bodies] : wrong) {
    const bool readable =
        std::string_view(path).find("time/m") && std::string_view(path) != "time/ntp/force-sync";
    const std::string before = readable ? bench.get(path) : "";
    for (const char* body : bodies) {
      EXPECT_EQ(bench.post(path, body), 400) << path << " " << body;
    }
    EXPECT_EQ(readable ? bench.get(path) : "", before);
  }
  const std::string nested = "{\"x\":" + std::string(60'000, '[') + std::string(60, ']') + "}";
  EXPECT_EQ(bench.post("acoustics/range", nested), 400);
  ASSERT_EQ(bench.notices.size(), 1U);  // the first refusal
  EXPECT_EQ(
      bench.notices[0].text,
      "a client's POST /api/v1/integration/acoustics/enabled was refused with status 400: \"wrong type or "
      "value\"");
}

TEST(Controls, UnusedMembersOfUdpMayBeMissing) {
  Bench bench;
  EXPECT_EQ(bench.post("udp", R"({"mode":"disabled"})"), 204);
  EXPECT_EQ(bench.get("udp"),
            R"({"mode":"disabled","unicast_destination_ip":"","unicast_destination_port":0})");
}

TEST(Controls, APathOfALaterReleaseIsNotFound) {
  const std::pair<const char*, Release> paths[] = {{"about", {1, 4, 0}},
                                                   {"acoustics/enabled", {1, 4, 0}},
                                                   {"acoustics/mode", {1, 7, 0}},
                                                   {"acoustics/range", {1, 4, 0}},
                                                   {"acoustics/salinity", {1, 7, 0}},
                                                   {"acoustics/speed_of_sound", {1, 1, 0}},
                                                   {"status", {1, 1, 0}},
                                                   {"output/imu-batch/enabled", {1, 8, 0}},
                                                   {"temperature", {1, 4, 0}},
                                                   {"time/ntp", {1, 7, 1}},
                                                   {"time/status", {1, 7, 1}},
                                                   {"udp", {1, 5, 0}}};
  const Release with_time{1, 7, 1}, with_automatic_speed{1, 7, 0};
  for (const Release release : {Release{1, 3, 0}, {1, 5, 1}, {1, 6, 0}, {1, 7, 0}, {1, 7, 1}, {1, 8, 0}}) {
    Bench bench(of_release(release.major, release.minor, release.patch));
    for (const auto& [path, since] : paths) {
      EXPECT_EQ(bench.request("GET", path).status, release < since ? 404 : 200)
          << path << " " << release.minor;
    }
    EXPECT_EQ(bench.post("time/manual", "{}"), release < with_time ? 404 : 400);
    EXPECT_EQ(bench.post("acoustics/speed_of_sound", "0"), release < with_automatic_speed ? 400 : 204);
  }
}

TEST(Controls, OtherMethodsAndPathsAreRefused) {
  Bench bench;
  EXPECT_EQ(bench.request("GET", "/api/v1/integration").status, 404);
  EXPECT_EQ(bench.request("GET", "acoustics").status, 404);
  EXPECT_EQ(bench.request("GET", "/acoustics/enabled").status, 404);
  EXPECT_EQ(bench.request("POST", "about", "{}").status, 405);
  EXPECT_EQ(bench.request("GET", "time/manual").status, 405);
  EXPECT_EQ(bench.request("GET", "time/ntp/force-sync").status, 405);
  EXPECT_EQ(bench.request("DELETE", "udp").status, 405);
  EXPECT_NE(bench.get("/").find("emulates"), std::string::npos);
}

TEST(Controls, StatusHasTheFormOfTheRelease) {
  const auto status = [](int minor, int patch, double temperature_c) {
    DeviceConfig config = of_release(1, minor, patch);
    config.temperature_c = temperature_c;
    return json::parse(Bench(config).get("status"));
  };
  EXPECT_EQ(status(8, 0, 31.5).at("api"), json({{"id", "api-normal"},
                                                {"message", "Integration API is operational"},
                                                {"operational", true},
                                                {"status", "ok"}}));
  EXPECT_EQ(status(8, 0, 31.5).at("time").at("status"), "ok");
  EXPECT_TRUE(status(7, 0, 31.5).contains("systems_check"));
  EXPECT_FALSE(status(7, 0, 31.5).contains("time"));
  EXPECT_EQ(status(6, 0, 31.5).at("calibration").at("severity"), "info");
  EXPECT_FALSE(status(6, 0, 31.5).at("api").contains("status"));
  EXPECT_EQ(status(8, 0, 55.0).at("temperature").at("status"), "warning");
  EXPECT_EQ(status(8, 0, 60.0).at("temperature").at("status"), "error");
  EXPECT_EQ(status(8, 0, 60.0).at("temperature").at("operational"), false);
}

TEST(Controls, TemperatureHasAFraction) {
  DeviceConfig config = small();
  EXPECT_EQ(Bench(config).get("temperature"), "31.5");
  config.temperature_c = 31.0;
  EXPECT_EQ(Bench(config).get("temperature"), "31.0");
}

TEST(Controls, AHeadThatIsTooHotDoesNotTurnAcousticsOn) {
  DeviceConfig config = small();
  config.temperature_c = 60.0;
  config.acoustics = true;
  Bench bench(config);
  EXPECT_EQ(bench.get("acoustics/enabled"), "false");
  EXPECT_EQ(bench.post("acoustics/enabled", "true"), 409);
  EXPECT_EQ(bench.post("acoustics/enabled", "false"), 204);
  bench.run_for(1s);
  EXPECT_TRUE(bench.jobs.empty());
}

TEST(Controls, AClientSetsTheTimeOnlyWithoutATimeServer) {
  DeviceConfig config = small();
  config.utc_offset = 1'767'225'600s;
  Bench synced(config);
  synced.run_for(5s);
  EXPECT_EQ(synced.post("time/manual", R"({"now":"2027-01-01T00:00:00Z"})"), 409);
  EXPECT_EQ(json::parse(synced.get("time/status")), json({{"system_time", "2026-01-01T00:00:05.000000Z"},
                                                          {"ntp_synced", true},
                                                          {"ntp_synced_to", "auto"},
                                                          {"ntp_seconds_since_last_sync", 5}}));
  const Reply forced = synced.request("POST", "time/ntp/force-sync", R"({"timeout_seconds":3})");
  EXPECT_EQ(forced.status, 200);
  EXPECT_EQ(json::parse(forced.body).at("success"), true);
  EXPECT_EQ(json::parse(forced.body).at("status").at("ntp_seconds_since_last_sync"), 0);

  config.ntp_synced = false;
  config.clock_offset = -3600s;
  Bench alone(config);
  EXPECT_EQ(json::parse(alone.get("time/status")).at("system_time"), "2025-12-31T23:00:00.000000Z");
  alone.run_for(5s);
  EXPECT_EQ(alone.post("time/manual", R"({"now":"2027-01-01T00:00:00Z"})"), 204);
  alone.run_for(1s);
  EXPECT_EQ(json::parse(alone.get("time/status")), json({{"system_time", "2027-01-01T00:00:01.000000Z"},
                                                         {"ntp_synced", false},
                                                         {"ntp_synced_to", ""},
                                                         {"ntp_seconds_since_last_sync", nullptr}}));
  EXPECT_EQ(json::parse(alone.request("POST", "time/ntp/force-sync", R"({"timeout_seconds":3})").body)
                .at("success"),
            false);
}

}  // namespace
}  // namespace sonard::sonar3d15::testing
