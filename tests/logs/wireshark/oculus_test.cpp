// SPDX-License-Identifier: Apache-2.0
// Byte examples of the Oculus through the dissector. Expected values are read off docs/protocols/oculus.md
// (section 10) by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/hex_fixture.hpp"

namespace sonard::testing {
namespace {

using ::testing::HasSubstr;

const std::string prefix = "oculus_sonar.";
constexpr pcapng::Endpoint head{0xC0A80204, 52'100};
constexpr pcapng::Endpoint client{0xC0A80205, 40'000};

struct Expectation {
  std::string fixture;
  std::string message;
  Row fields;
  std::string complaint = "";
};

const std::string unstated = "The size is not stated: it follows from the kind (3.1)";

const std::vector<Expectation> commands{
    {"fire_vendor",
     "simple_fire",
     {{"fire.masterMode", "1"},
      {"fire.flags", "0x49"},
      {"fire.range", "10"},
      {"fire.gainPercent", "20"},
      {"fire.salinity", "35"},
      {"body_version", "1"},
      {"from_head", "0"}},
     unstated},
    {"fire_ensta_standby", "simple_fire", {{"fire.pingRate", "5"}, {"fire.speedOfSound", "1500"}}},
    {"fire_ensta_resume_v2", "simple_fire", {{"header.msgVersion", "2"}, {"body_version", "1"}}},
    {"fire_liboculus_32_bit",
     "simple_fire",
     {{"fire_extension.extFlags", "0x00000200"}, {"body_version", "2"}}},
    {"user_config_request", "user_config", {{"address", "0.0.0.0"}}, unstated},
};

const std::vector<Expectation> reports{
    {"ping_result_v1",
     "simple_ping_result",
     {{"header.srcDeviceId", "7892"},
      {"header.partNumber", "1042"},
      {"result_v1.pingId", "42"},
      {"result_v1.frequency", "750000"},
      {"result_v1.temperature", "18.5"},
      {"result_v1.nRanges", "3"},
      {"result_v1.nBeams", "4"},
      {"result_v1.imageOffset", "136"},
      {"first_bearing_deg", "-65"},
      {"last_bearing_deg", "65"},
      {"bits", "8"},
      {"image", "0100000000010203040000000a0b0c0d1000000014151617"},
      {"from_head", "1"}}},
    {"ping_result_v2",
     "simple_ping_result",
     {{"result_v2.pingId", "43"},
      {"result_v2.frequency", "2100000"},
      {"result_v2.heading", "90"},
      {"result_v2.pitch", "-1.5"},
      {"result_v2.pingStartTime", "12.345678"},
      {"bits", "16"},
      {"last_bearing_deg", "30"}}},
    {"dummy", "dummy", {{"header.payloadSize", "0"}}},
    {"user_config", "user_config", {{"address", "192.168.2.4"}}},
};

std::vector<std::string> fields_of(const std::vector<Expectation>& expectations) {
  std::vector<std::string> fields{prefix + "message", expert_field};
  for (const Expectation& expected : expectations) {
    for (const auto& [field, value] : expected.fields) {
      fields.push_back(prefix + field);
    }
  }
  return fields;
}

void expect(const Row& row, const Expectation& expected) {
  SCOPED_TRACE(expected.fixture);
  EXPECT_EQ(row.at(prefix + "message"), expected.message);
  EXPECT_EQ(row.at(expert_field), expected.complaint);
  for (const auto& [field, value] : expected.fields) {
    EXPECT_EQ(row.at(prefix + field), value) << field;
  }
}

TEST(OculusDissector, FieldsOfCommands) {
  pcapng::TcpConversation line{client, head};
  std::vector<pcapng::Bytes> packets;
  for (const Expectation& expected : commands) {
    packets.push_back(line.from_client(load_hex_fixture("oculus", expected.fixture)).at(0));
  }
  const auto rows = dissect(packets, fields_of(commands));
  for (std::size_t i = 0; i < commands.size(); ++i) {
    expect(rows[i], commands[i]);
  }
}

TEST(OculusDissector, FieldsOfReports) {
  pcapng::TcpConversation line{client, head};
  std::vector<pcapng::Bytes> packets;
  for (const Expectation& expected : reports) {
    packets.push_back(line.from_server(load_hex_fixture("oculus", expected.fixture)).at(0));
  }
  const auto rows = dissect(packets, fields_of(reports));
  for (std::size_t i = 0; i < reports.size(); ++i) {
    expect(rows[i], reports[i]);
  }
}

TEST(OculusDissector, FieldsOfAStatus) {
  const Expectation expected{"status",
                             "status",
                             {{"status.deviceId", "7892"},
                              {"status.partNumber", "1042"},
                              {"status.status", "0x00000003"},
                              {"address", "192.168.2.4"},
                              {"client", "0.0.0.0"},
                              {"status.pressure", "1.25"}}};
  const pcapng::Bytes packet = pcapng::udp_packet({head.address, 50'000}, {0xFFFFFFFF, 52'102},
                                                  load_hex_fixture("oculus", expected.fixture));
  expect(dissect({packet}, fields_of({expected}))[0], expected);
}

TEST(OculusDissector, AStreamIsPutTogetherFromAnyPieces) {
  Bytes stream;
  std::string names;
  for (const Expectation& expected : reports) {
    const Bytes message = load_hex_fixture("oculus", expected.fixture);
    stream.insert(stream.end(), message.begin(), message.end());
    names += expected.message + ",";
  }
  for (const std::size_t piece : {2000U, 50U, 3U}) {
    SCOPED_TRACE(piece);
    pcapng::TcpConversation line{client, head};
    std::vector<pcapng::Bytes> packets = line.open();
    for (std::size_t begin = 0; begin < stream.size(); begin += piece) {
      const auto sent =
          line.from_server(pcapng::ByteView{stream}.subspan(begin, std::min(piece, stream.size() - begin)));
      packets.insert(packets.end(), sent.begin(), sent.end());
    }
    std::string found;
    std::string complaints;
    for (const Row& row :
         dissect(packets, {prefix + "message", prefix + "malformed", prefix + "no_message"})) {
      found += row.at(prefix + "message").empty() ? "" : row.at(prefix + "message") + ",";
      complaints += row.at(prefix + "malformed") + row.at(prefix + "no_message");
    }
    EXPECT_EQ(found, names);
    EXPECT_EQ(complaints, "");
  }
}

TEST(OculusDissector, GarbageAndSizesThatDoNotFitAreShown) {
  Bytes bytes{'S', 'x', 'O'};
  Bytes ping = load_hex_fixture("oculus", "ping_result_v1");
  ping.at(106) = 2;  // rows
  bytes.insert(bytes.end(), ping.begin(), ping.end());
  pcapng::TcpConversation line{client, head};
  const Row row = dissect(line.from_server(bytes), {prefix + "message", prefix + "garbage", expert_field})[0];
  EXPECT_EQ(row.at(prefix + "message"), "simple_ping_result");
  EXPECT_EQ(row.at(prefix + "garbage"), "53784f");
  EXPECT_THAT(row.at(expert_field), HasSubstr("belong to no message"));
  EXPECT_THAT(row.at(expert_field), HasSubstr("do not fit each other"));
}

}  // namespace
}  // namespace sonard::testing
