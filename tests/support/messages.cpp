// SPDX-License-Identifier: Apache-2.0
#include "tests/support/messages.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <stdexcept>

#include "tests/support/message_fields.hpp"

namespace sonard::testing {
namespace {

Message read_message(const Json& json) {
  Message message;
  message.name = json.at("name");
  message.from_head = json.at("from") == "head";
  message.message = json.at("message");
  message.bytes = bytes_of(json.at("bytes"));
  message.fields = json.at("fields");
  message.wireshark = json.value("wireshark", Json::object());
  message.is_written = json.value("written", true);
  message.is_cut = json.value("is_cut", false);
  return message;
}

std::vector<Message> read_messages(const std::string& device) {
  std::ifstream file{SONARD_SOURCE_DIR "/tests/data/" + device + "/messages.json"};
  std::vector<Message> messages;
  for (const Json& json : Json::parse(file)) {
    messages.push_back(read_message(json));
  }
  std::ranges::sort(messages, {}, &Message::name);
  return messages;
}

}  // namespace

Bytes bytes_of(const Json& json) {
  if (json.is_array()) {
    Bytes all;
    for (const Json& part : json) {
      const Bytes bytes = bytes_of(part);
      all.insert(all.end(), bytes.begin(), bytes.end());
    }
    return all;
  }
  std::string digits = json.get<std::string>();
  std::erase(digits, ' ');
  Bytes bytes(digits.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(std::stoul(digits.substr(2 * i, 2), nullptr, 16));
  }
  return bytes;
}

const std::vector<Message>& messages_of(std::string_view device) {
  static std::map<std::string, std::vector<Message>> read;
  const auto [found, is_new] = read.try_emplace(std::string{device});
  if (is_new) {
    found->second = read_messages(found->first);
  }
  return found->second;
}

const Message& message_of(std::string_view device, std::string_view name) {
  const auto& messages = messages_of(device);
  const auto found = std::ranges::find(messages, name, &Message::name);
  if (found == messages.end()) {
    throw std::runtime_error{std::string{device} + " has no message " + std::string{name}};
  }
  return *found;
}

Bytes message_bytes(const std::string& device, const std::string& name) {
  return message_of(device, name).bytes;
}

std::vector<std::string> message_names(const std::string& device) {
  std::vector<std::string> names;
  for (const Message& message : messages_of(device)) {
    names.push_back(message.name);
  }
  return names;
}

}  // namespace sonard::testing
