// SPDX-License-Identifier: Apache-2.0
// The host's side of the JSON stream, for viewers and tests.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/dvl_a50/json.hpp"
#include "protocol/dvl_a50/messages.hpp"

namespace sonard::dvl_a50 {

/// The answer to a command, as it came.
struct ReceivedResponse {
  std::string command;
  bool success = false;
  std::string error;
  Json result;
};
using Report = std::variant<Velocity, Position, ReceivedResponse>;

/// Takes a stream in any pieces. Messages that are none of these are counted and dropped.
class Client {
 public:
  void on_bytes(std::span<const std::uint8_t> bytes) { stream_.append(bytes); }
  /// The reports that are complete, in order.
  std::vector<Report> take();
  std::uint64_t unreadable() const { return unreadable_; }
  std::uint64_t dropped_bytes() const { return stream_.dropped(); }  ///< outside objects

 private:
  JsonStream stream_;
  std::uint64_t unreadable_ = 0;
};

/// A command without a line end. `parameters` is a JSON object; empty: none.
std::string command_text(std::string_view name, std::string_view parameters = {});

}  // namespace sonard::dvl_a50
