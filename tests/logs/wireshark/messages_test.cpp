// SPDX-License-Identifier: Apache-2.0
// Every message of tests/data through the dissectors: Wireshark shows the fields that codecs read and write,
// and complains about none.
#include <gtest/gtest.h>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/message_fields.hpp"

namespace sonard::testing {
namespace {

struct Link {
  std::string device;
  std::uint16_t tcp_port = 0;  ///< 0: all messages are datagrams
  std::uint16_t udp_port = 0;
  bool shows_direction = true;
  bool shows_contents = true;  ///< false: of a message of Protobuf, what `wireshark` in its example lists
};

void PrintTo(const Link& link, std::ostream* out) {
  *out << link.device;
}

const Link links[]{{"dvl_a50", 0, 16'171},
                   {"gemini", 0, 52'900, false},
                   {"micron", 0, 4002},
                   {"oculus", 52'100, 52'102},
                   {"ping1d", 0, 9090},
                   {"ping360", 0, 12'345},
                   {"sonar3d15", 0, 4747, false, false}};

std::vector<pcapng::Bytes> packets_of(const Link& link, const std::vector<Message>& messages) {
  const pcapng::Endpoint client{0x7F000001, 50'000};
  const pcapng::Endpoint head{0x7F000002, link.udp_port};
  pcapng::TcpConversation line{client, {head.address, link.tcp_port}};
  std::vector<pcapng::Bytes> packets;
  for (const Message& message : messages) {
    if (link.tcp_port != 0 && message.name != "status") {
      packets.push_back(
          (message.from_head ? line.from_server(message.bytes) : line.from_client(message.bytes)).at(0));
    } else {
      packets.push_back(message.from_head ? pcapng::udp_packet(head, client, message.bytes)
                                          : pcapng::udp_packet(client, head, message.bytes));
    }
  }
  return packets;
}

/// A number in decimal digits, other texts as they are.
std::string normal(const std::string& text) {
  return text.starts_with("0x") ? std::to_string(std::stoull(text, nullptr, 16)) : text;
}

/// The text that Wireshark shows for a value: a list joined by commas, or bytes.
std::string text_of(const Json& value) {
  if (!value.is_array()) {
    return value.is_string() ? normal(value.get<std::string>()) : value.dump();
  }
  std::string all;
  for (const Json& part : value) {
    const bool continues_bytes = part.is_string() && !part.get<std::string>().starts_with("0x");
    all += (all.empty() || continues_bytes ? "" : ",") + text_of(part);
  }
  return all;
}

std::string normal_list(const std::string& text) {
  std::string all;
  std::istringstream parts{text};
  for (std::string part; std::getline(parts, part, ',');) {
    all += (all.empty() ? "" : ",") + normal(part);
  }
  return all;
}

/// Adds the fields in `value` to `row`. A field in a group is GROUP.FIELD, a part of a field FIELD_PART.
void add_fields(Row& row, const std::string& name, char separator, const Json& value) {
  if (!value.is_object()) {
    row[name] = text_of(value);
    return;
  }
  for (const auto& [part, inner] : value.items()) {
    add_fields(row, name + separator + part, '_', inner);
  }
}

/// What Wireshark must show, by the whole name of the field.
Row expected_row(const Link& link, const Message& message) {
  const std::string prefix = link.device + "_sonar.";
  Row row{{prefix + "message", message.message}, {expert_field, ""}};
  if (link.shows_direction) {
    row[prefix + "from_head"] = message.from_head ? "1" : "0";
  }
  for (const auto& [name, value] : message.fields.items()) {
    if (link.shows_contents || name != "message") {
      add_fields(row, prefix + name, '.', value);
    }
  }
  for (const auto& [field, value] : message.wireshark.items()) {
    row[field == expert_field ? field : prefix + field] = text_of(value);
  }
  return row;
}

class Dissector : public ::testing::TestWithParam<Link> {};

TEST_P(Dissector, ShowsTheFieldsOfEveryMessage) {
  const auto messages = complete_messages(GetParam().device);
  std::set<std::string> fields{"udp.checksum.status", "tcp.checksum.status"};
  for (const Message& message : messages) {
    for (const auto& [field, value] : expected_row(GetParam(), message)) {
      fields.insert(field);
    }
  }
  const auto rows = dissect(packets_of(GetParam(), messages), {fields.begin(), fields.end()});
  for (std::size_t i = 0; i < messages.size(); ++i) {
    SCOPED_TRACE(messages[i].name);
    EXPECT_EQ(rows[i].at("udp.checksum.status") + rows[i].at("tcp.checksum.status"), "1");
    for (const auto& [field, value] : expected_row(GetParam(), messages[i])) {
      EXPECT_EQ(normal_list(rows[i].at(field)), value) << field;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(all, Dissector, ::testing::ValuesIn(links),
                         [](const auto& link) { return link.param.device; });

}  // namespace
}  // namespace sonard::testing
