// SPDX-License-Identifier: Apache-2.0
// Lines of the log as JSON, for programs that collect them (docs/deploy.md).
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <spdlog/formatter.h>
#include <nlohmann/json.hpp>

namespace sonard::server {

/// One object on one line, in this order: "time" (UTC, RFC 3339, milliseconds), "level" (trace, debug, info,
/// warning, error, critical), "head" (of a line about one head) or "area" (what the line is about),
/// "message", and "keys", an object of the key=value pairs of the message with numbers as numbers.
class JsonLines final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override;
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonLines>(); }
};

/// "head" or "area", "message" and "keys" of a line.
nlohmann::ordered_json members_of(std::string_view line);

}  // namespace sonard::server
