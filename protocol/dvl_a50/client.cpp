// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/client.hpp"

#include <optional>

#include <fmt/format.h>

#include "protocol/dvl_a50/codec.hpp"

namespace sonard::dvl_a50 {
namespace {

std::optional<Report> decode_response(const Json& message) {
  const Json* const command = message.find("response_to");
  const Json* const success = message.find("success");
  const Json* const error = message.find("error_message");
  const Json* const result = message.find("result");
  if (command == nullptr || command->as<std::string>() == nullptr || success == nullptr ||
      success->as<bool>() == nullptr || error == nullptr || error->as<std::string>() == nullptr ||
      result == nullptr) {
    return std::nullopt;
  }
  return ReceivedResponse{*command->as<std::string>(), *success->as<bool>(), *error->as<std::string>(),
                          *result};
}

std::optional<Report> decode(const std::string& text) {
  const std::optional<Json> message = parse_json(text);
  if (!message) {
    return std::nullopt;
  }
  if (const auto velocity = decode_velocity(*message)) {
    return *velocity;
  }
  if (const auto position = decode_position(*message)) {
    return *position;
  }
  return decode_response(*message);
}

}  // namespace

std::vector<Report> Client::take() {
  std::vector<Report> reports;
  while (const std::optional<std::string> text = stream_.next()) {
    if (std::optional<Report> report = decode(*text)) {
      reports.push_back(*std::move(report));
    } else {
      ++unreadable_;
    }
  }
  return reports;
}

std::string command_text(std::string_view name, std::string_view parameters) {
  return parameters.empty() ? fmt::format(R"({{"command":"{}"}})", name)
                            : fmt::format(R"({{"command":"{}","parameters":{}}})", name, parameters);
}

}  // namespace sonard::dvl_a50
