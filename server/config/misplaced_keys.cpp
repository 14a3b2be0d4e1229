// SPDX-License-Identifier: Apache-2.0
#include "server/config/misplaced_keys.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include <fmt/format.h>

namespace sonard::server {
namespace {

constexpr std::string_view complaint = "unknown key";

/// Paths of all keys with a name. If a mapping got a plain value, its path ends with the mapping's first key.
void find_paths(const std::vector<KeyReference>& keys, const std::string& path, const UnknownKey& wanted,
                std::set<std::string>& found) {
  for (const KeyReference& key : keys) {
    const std::string here = path.empty() ? key.name : fmt::format("{}.{}", path, key.name);
    if (key.name == wanted.name) {
      found.insert(wanted.has_value && !key.keys.empty() ? fmt::format("{}.{}", here, key.keys.front().name)
                                                         : here);
    }
    // Paths of a head's keys begin at the head, as in the documents.
    find_paths(key.keys, here == "heads" ? "" : here, wanted, found);
  }
}

}  // namespace

void name_sections(std::vector<ConfigProblem>& problems, std::span<const UnknownKey> unknown,
                   std::span<const std::vector<KeyReference>> known) {
  for (const UnknownKey& key : unknown) {
    std::set<std::string> found;
    for (const std::vector<KeyReference>& keys : known) {
      find_paths(keys, "", key, found);
    }
    std::string& message = problems[key.problem].message;
    if (found.size() == 1 && message.starts_with(complaint)) {
      message.insert(complaint.size(), fmt::format("; it is '{}'", *found.begin()));
    }
  }
}

}  // namespace sonard::server
