// SPDX-License-Identifier: Apache-2.0
// Counts log lines by reason, so that a rare reason is not lost among many lines with another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace sonard::server {

/// The reason of a line is its text without digits and without single-quoted text, so that addresses, counts
/// and names of peers do not make new reasons. Belongs to one thread.
class Reasons {
 public:
  /// Counts a line under its reason. All reasons beyond `most` share one count: a peer that invents reasons
  /// must not fill memory or log.
  /// @return number of lines with this reason, including this one
  std::uint64_t count(std::string_view text);

  static constexpr std::size_t most = 32;

 private:
  std::map<std::string, std::uint64_t, std::less<>> counts_;
  std::uint64_t others_ = 0;
};

}  // namespace sonard::server
