// SPDX-License-Identifier: Apache-2.0
#include "server/yaml/misplaced_keys.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "server/yaml/yaml_trouble.hpp"

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
KnownPaths paths_of(const UnknownKey& key, std::span<const TypeKeys> known,
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

/// The types of heads that have a key of this path.
std::vector<std::string_view> types_with(const std::string& name, const std::string& path,
                                         std::span<const TypeKeys> known, std::span<const KeyIndex> indexes) {
  std::vector<std::string_view> types;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const auto entry = indexes[i].find(name);
    if (entry != indexes[i].end() && entry->second.of_key.contains(path)) {
      types.emplace_back(known[i].type);
    }
  }
  return types;
}

/// The places in the section that holds the key: "acoustics.physical.speckle" and "acoustics.paper.speckle"
/// for "acoustics.speckle".
std::vector<std::string> paths_inside(const std::string& here, const std::set<std::string>& paths) {
  const std::size_t dot = here.rfind('.');
  std::vector<std::string> inside;
  if (dot != std::string::npos) {
    std::ranges::copy_if(paths, std::back_inserter(inside), [&](const std::string& path) {
      return path.starts_with(std::string_view(here).substr(0, dot + 1));
    });
  }
  return inside;
}

/// The mapping at a path from the head or the root on, or null. Indexes of lists are ignored.
const KeyReference* mapping_at(const std::vector<KeyReference>& keys, std::string_view path) {
  const std::size_t dot = path.find('.');
  const std::string_view name = path.substr(0, dot);
  const auto found = std::ranges::find(keys, name.substr(0, name.find('[')), &KeyReference::name);
  if (found == keys.end()) {
    return nullptr;
  }
  return dot == std::string_view::npos ? &*found : mapping_at(found->keys, path.substr(dot + 1));
}

/// The only key of a mapping that can have this word as its value; empty unless exactly one key can.
std::string key_with_value(const KeyReference& mapping, std::string_view word) {
  const std::string quoted = fmt::format("\"{}\"", word);
  const bool is_boolean = word == "true" || word == "false";
  std::string only;
  for (const KeyReference& key : mapping.keys) {
    const bool fits = key.schema.find(quoted) != std::string::npos ||
                      (is_boolean && key.schema.find("\"boolean\"") != std::string::npos);
    if (fits && !only.empty()) {
      return {};
    }
    only = fits ? key.name : only;
  }
  return only;
}

}  // namespace

void name_keys(std::vector<ConfigProblem>& problems, std::span<const WordForMapping> words,
               std::span<const TypeKeys> known) {
  for (const WordForMapping& given : words) {
    ConfigProblem& problem = problems[given.problem];
    const auto type = std::ranges::find_if(
        known, [&](const TypeKeys& keys) { return given.head_type.empty() || keys.type == given.head_type; });
    const KeyReference* const mapping = type == known.end() ? nullptr : mapping_at(type->keys, problem.key);
    if (mapping == nullptr) {
      continue;
    }
    const std::string first = given.word.substr(0, given.word.find_first_of(" ="));
    const std::string colon = missing_colon(given.word);
    if (!colon.empty() &&
        std::ranges::find(mapping->keys, first, &KeyReference::name) != mapping->keys.end()) {
      problem.message = colon;
    } else if (const std::string key = key_with_value(*mapping, given.word); !key.empty()) {
      problem.message = fmt::format("is '{0}' (expected a mapping such as {{{1}: {0}}})", given.word, key);
    }
  }
}

void name_sections(std::vector<ConfigProblem>& problems, std::span<const UnknownKey> unknown,
                   std::span<const TypeKeys> known) {
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
    } else if (const auto inside = paths_inside(here, paths);
               !all.of_key.contains(here) && (inside.size() == 1 || inside.size() == 2)) {
      problem.message.insert(complaint.size(),
                             fmt::format(" here, did you mean '{}'?", fmt::join(inside, "' or '")));
    } else if (const auto types = types_with(key.name, here, known, indexes);
               !key.head_type.empty() && !types.empty()) {
      problem.message.insert(complaint.size(), fmt::format(" of a {}, it is a key of {}", key.head_type,
                                                           fmt::join(types, ", ")));
    }
  }
}

}  // namespace sonard::server
