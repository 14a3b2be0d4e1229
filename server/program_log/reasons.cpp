// SPDX-License-Identifier: Apache-2.0
#include "server/program_log/reasons.hpp"

namespace sonard::server {
namespace {

constexpr std::size_t longest_reason = 200;

std::string reason_in(std::string_view text) {
  std::string reason;
  bool quoted = false;
  for (const char c : text) {
    if (c == '\'') {
      quoted = !quoted;
    } else if (!quoted && (c < '0' || c > '9') && reason.size() < longest_reason) {
      reason += c;
    }
  }
  return reason;
}

}  // namespace

std::uint64_t Reasons::count(std::string_view text) {
  const std::string reason = reason_in(text);
  if (const auto known = counts_.find(reason); known != counts_.end()) {
    return ++known->second;
  }
  return counts_.size() < most ? ++counts_[reason] : ++others_;
}

}  // namespace sonard::server
