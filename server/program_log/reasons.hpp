// SPDX-License-Identifier: Apache-2.0
// How often each reason for a line of the log came, so that a rare one is not lost among many of another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace sonard::server {

/// The reason of a line is its text without digits and without what stands in single quotes: addresses,
/// counts and names of peers make no new reason. Belongs to one thread.
class Reasons {
 public:
  /// Counts a line under its reason. Beyond `most` reasons all further ones share a count: a peer that
  /// invents new ones fills neither memory nor log.
  /// @return how many lines with this reason came, this one included
  std::uint64_t count(std::string_view text);

  static constexpr std::size_t most = 32;

 private:
  std::map<std::string, std::uint64_t, std::less<>> counts_;
  std::uint64_t others_ = 0;
};

}  // namespace sonard::server
