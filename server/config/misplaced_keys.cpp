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
  std::set<std::string> of_key;    ///< "acoustics.physical.multipath"
  std::set<std::string> of_value;  ///< of a mapping, the path of its first key
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

/// The path of a key, from the head on if a head holds it: "mount.roll" for "heads[0].mount.roll".
std::string path_in_head(const std::string& key) {
  return key.starts_with("heads[") ? key.substr(key.find('.') + 1) : key;
}

/// The paths of a name in files whose heads are of this type, or of any type if it is empty.
KnownPaths paths_of(const UnknownKey& key, std::span<const KindKeys> known,
                    std::span<const KeyIndex> indexes) {
  KnownPaths paths;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const auto entry = indexes[i].find(key.name);
    if (entry != indexes[i].end() && (key.head_type.empty() || key.head_type == known[i].type)) {
      paths.of_key.insert(entry->second.of_key.begin(), entry->second.of_key.end());
      paths.of_value.insert(entry->second.of_value.begin(), entry->second.of_value.end());
    }
  }
  return paths;
}

/// The kinds of heads that have a key of this path.
std::vector<std::string_view> kinds_with(const std::string& name, const std::string& path,
                                         std::span<const KindKeys> known, std::span<const KeyIndex> indexes) {
  std::vector<std::string_view> kinds;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const auto entry = indexes[i].find(name);
    if (entry != indexes[i].end() && entry->second.of_key.contains(path)) {
      kinds.emplace_back(known[i].type);
    }
  }
  return kinds;
}

}  // namespace

void name_sections(std::vector<ConfigProblem>& problems, std::span<const UnknownKey> unknown,
                   std::span<const KindKeys> known) {
  std::vector<KeyIndex> indexes(known.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    add_keys(known[i].keys, "", indexes[i]);
  }
  for (const UnknownKey& key : unknown) {
    ConfigProblem& problem = problems[key.problem];
    if (!problem.message.starts_with(complaint)) {
      continue;
    }
    const std::string here = path_in_head(problem.key);
    const KnownPaths all = paths_of(key, known, indexes);
    const std::set<std::string>& paths = key.has_value ? all.of_value : all.of_key;
    if (paths.size() == 1 && !all.of_key.contains(here)) {
      problem.message.insert(complaint.size(), fmt::format(" here, did you mean '{}'?", *paths.begin()));
    } else if (const auto kinds = kinds_with(key.name, here, known, indexes);
               !key.head_type.empty() && !kinds.empty()) {
      problem.message.insert(complaint.size(), fmt::format(" of a {}, it is a key of {}", key.head_type,
                                                           fmt::join(kinds, ", ")));
    }
  }
}

}  // namespace sonard::server
