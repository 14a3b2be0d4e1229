// SPDX-License-Identifier: Apache-2.0
#include "server/offline/options.hpp"

#include <charconv>

namespace sonard::server {

std::optional<Shard> parse_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec != std::errc() || index.ptr == end || *index.ptr != '/') {
    return std::nullopt;
  }
  const auto count = std::from_chars(index.ptr + 1, end, shard.count);
  const bool good = count.ec == std::errc() && count.ptr == end && shard.count >= 1 && shard.index >= 0 &&
                    shard.index <= shard.count;
  return good ? std::optional(shard) : std::nullopt;
}

}  // namespace sonard::server
