// SPDX-License-Identifier: Apache-2.0
#include "server/config/misplaced_keys.hpp"

#include <set>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>

namespace sonard::server {
namespace {

constexpr std::string_view complaint = "unknown key";

/// The paths at which a key's name is known.
struct KnownPaths {
  std::set<std::string> of_key;  ///< "acoustics.physical.multipath"
  std::set<std::string>
      of_value;  ///< the same; the path of a mapping's first key in place of the mapping's own
};

/// All names of keys, each with its paths. The keys of a head have paths that begin at the head, as in the
/// documents.
using KeyIndex = std::unordered_map<std::string, KnownPaths>;

void add_keys(const std::vector<KeyReference>& keys, const std::string& path, KeyIndex& index) {
  for (const KeyReference& key : keys) {
    const std::string here = path.empty() ? key.name : fmt::format("{}.{}", path, key.name);
    KnownPaths& paths = index[key.name];
    paths.of_key.insert(here);
    paths.of_value.insert(key.keys.empty() ? here : fmt::format("{}.{}", here, key.keys.front().name));
    add_keys(key.keys, here == "heads" ? "" : here, index);
  }
}

}  // namespace

void name_sections(std::vector<ConfigProblem>& problems, std::span<const UnknownKey> unknown,
                   std::span<const std::vector<KeyReference>> known) {
  KeyIndex index;
  for (const std::vector<KeyReference>& keys : known) {
    add_keys(keys, "", index);
  }
  for (const UnknownKey& key : unknown) {
    const auto entry = index.find(key.name);
    if (entry == index.end()) {
      continue;
    }
    const std::set<std::string>& paths = key.has_value ? entry->second.of_value : entry->second.of_key;
    std::string& message = problems[key.problem].message;
    if (paths.size() == 1 && message.starts_with(complaint)) {
      message.insert(complaint.size(), fmt::format(" here, did you mean '{}'?", *paths.begin()));
    }
  }
}

}  // namespace sonard::server
