// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/grouped_warnings.hpp"

#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sonard::render {

void GroupedWarnings::add(const std::string& kind, const std::string& place, const std::string& name) {
  constexpr std::size_t most_names = 6;
  Group& group = groups_.try_emplace(kind, Group{place, {}, {}}).first->second;
  if (group.names.insert(name).second && group.first.size() < most_names) {
    group.first.push_back(name);
  }
}

std::vector<std::string> GroupedWarnings::lines() const {
  std::vector<std::string> result;
  for (const auto& [kind, group] : groups_) {
    result.push_back(fmt::format("{}: {} ({}): {}{}", group.place, kind, group.names.size(),
                                 fmt::join(group.first, ", "),
                                 group.first.size() < group.names.size() ? ", ..." : ""));
  }
  return result;
}

}  // namespace sonard::render
