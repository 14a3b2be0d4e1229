// SPDX-License-Identifier: Apache-2.0
// Formats log lines as JSON, for log collectors (docs/deploy.md).
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <spdlog/formatter.h>
#include <nlohmann/json.hpp>

namespace sonard::server {

/// One object per line, in this order: "time" (UTC, RFC 3339, milliseconds), "level" (trace, debug, info,
/// warning, error, critical), "head" (for lines about one head) or "area" (the subject of the line),
/// "message", and "keys", an object of the message's key=value pairs, with numbers as numbers.
class JsonLines final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override;
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonLines>(); }
};

/// "head" or "area", "message" and "keys" of a line.
nlohmann::ordered_json members_of(std::string_view line);

}  // namespace sonard::server
