// SPDX-License-Identifier: Apache-2.0
// Writes configs/schema/sonard.schema.json and the reference in docs/configuration.md from the loader's keys.
// With --check it only reports whether these files are up to date.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/config/loader.hpp"
#include "server/devices/kinds/kinds.hpp"

namespace sonard::server {
namespace {

constexpr std::string_view beginning =
    "<!-- From here to the end written by write_configuration_reference, from section.cpp of config and "
    "devices "
    "-->\n";

using Keys = std::vector<KeyReference>;

// ---- The schema

std::string json_string(const std::string& text) {
  return nlohmann::json(text).dump();
}

/// The text that an editor shows. Links are removed, because they are relative to docs/.
std::string description_of(const KeyReference& key) {
  const std::string gap = key.meaning.empty() || key.introduction.empty() ? "" : ". ";
  const std::string text =
      std::regex_replace(key.meaning + gap + key.introduction, std::regex(R"(\[([^\]]+)\]\([^)]+\))"), "$1");
  return text.empty() ? "" : R"(, "description": )" + json_string(text);
}

std::string value_schema(const KeyReference& key, const std::string& margin);

std::string mapping_schema(const Keys& keys, const std::string& description, const std::string& margin) {
  std::string required;
  std::string properties;
  for (const KeyReference& key : keys) {
    if (key.required) {
      required += (required.empty() ? "" : ", ") + json_string(key.name);
    }
    properties += fmt::format("{}\n{}  {}: {}", properties.empty() ? "" : ",", margin, json_string(key.name),
                              value_schema(key, margin + "  "));
  }
  return fmt::format(
      R"({{"type": "object"{}, "additionalProperties": false, "required": [{}], "properties": {{{}}}}})",
      description, required, properties);
}

std::string value_schema(const KeyReference& key, const std::string& margin) {
  if (!key.keys.empty() && !key.is_list) {
    const std::string mapping = mapping_schema(key.keys, description_of(key), margin);
    return key.schema.empty() ? mapping : fmt::format(R"({{"anyOf": [{{{}}}, {}]}})", key.schema, mapping);
  }
  const bool has_default = !key.required && !key.default_json.empty();
  const std::string rest = (has_default ? R"(, "default": )" + key.default_json : "") + description_of(key);
  return key.is_list ? fmt::format(R"({{"type": "array"{}, "items": {}}})", rest,
                                   mapping_schema(key.keys, "", margin))
                     : fmt::format("{{{}{}}}", key.schema, rest);
}

/// Documents differ only in `heads`, their last key, because each head is of one of the kinds.
std::string schema_of(const std::vector<Keys>& of_kinds) {
  Keys document = of_kinds.front();
  std::string heads;
  for (const Keys& keys : of_kinds) {
    heads += (heads.empty() ? "" : ", ") + mapping_schema(keys.back().keys, "", "  ");
  }
  KeyReference& head = document.back();
  head.schema = fmt::format(R"("type": "array", "minItems": 1, "items": {{"oneOf": [{}]}})", heads);
  head.keys.clear();
  head.is_list = false;
  std::string text = mapping_schema(document, "", "");
  text.insert(1, R"("$schema": "https://json-schema.org/draft/2020-12/schema",
"title": "sonard configuration", "description": "See docs/configuration.md",
)");
  return text + "\n";
}

// ---- The tables

struct Table {
  std::vector<std::string> paths;  ///< paths of the mappings with these keys: "heads[].mount"
  std::vector<std::string> kinds;  ///< kinds of heads with these mappings
  std::string introduction;
  Keys keys;
  std::vector<std::string> defaults;  ///< defaults of the keys, and kinds with other defaults
};

std::string default_of(const KeyReference& key) {
  return key.required ? "**required**" : key.default_text;
}

bool same_but_for_defaults(const KeyReference& one, const KeyReference& other) {
  return one.name == other.name && one.type == other.type && one.meaning == other.meaning &&
         one.required == other.required;
}

void add_once(std::vector<std::string>& list, const std::string& text) {
  if (std::find(list.begin(), list.end(), text) == list.end()) {
    list.push_back(text);
  }
}

/// Adds a mapping and all mappings inside it. If a table has the same keys, the mapping joins this table.
void add_tables(const Keys& keys, const std::string& path, const std::string& introduction,
                const std::string& kind, std::vector<Table>& tables) {
  auto table = std::find_if(tables.begin(), tables.end(), [&](const Table& other) {
    return other.introduction == introduction &&
           std::equal(other.keys.begin(), other.keys.end(), keys.begin(), keys.end(), same_but_for_defaults);
  });
  if (table == tables.end()) {
    table = tables.insert(table, {{}, {}, introduction, keys, {}});
    std::transform(keys.begin(), keys.end(), std::back_inserter(table->defaults), default_of);
  }
  add_once(table->paths, path);
  add_once(table->kinds, kind);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::string other = fmt::format("; {}: {}", kind, default_of(keys[i]));
    if (default_of(keys[i]) != default_of(table->keys[i]) && !table->defaults[i].ends_with(other)) {
      table->defaults[i] += other;
    }
  }
  for (const KeyReference& key : keys) {
    if (!key.keys.empty()) {
      add_tables(key.keys, (path.empty() ? "" : path + ".") + key.name + (key.is_list ? "[]" : ""),
                 key.introduction, kind, tables);
    }
  }
}

std::string cell(const std::string& text) {
  return text.empty() ? " " : ' ' + text + ' ';
}

/// Breaks a paragraph into lines of at most 120 characters, at blanks outside of `code`.
std::string folded(const std::string& paragraph) {
  constexpr std::size_t longest = 120;
  std::string text = paragraph;
  std::size_t begin = 0, blank = 0;
  bool code = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    code = code != (text[i] == '`');
    if (i - begin >= longest && blank > begin) {
      text[blank] = '\n';
      begin = blank + 1;
    }
    if (text[i] == ' ' && !code) {
      blank = i;
    }
  }
  return text;
}

std::string text_of(const Table& table, std::size_t kind_count) {
  std::string text = table.paths.front().empty() ? "\n### Top level"
                                                 : fmt::format("\n### `{}`", fmt::join(table.paths, "`, `"));
  text += table.kinds.size() < kind_count ? fmt::format(" ({})\n\n", fmt::join(table.kinds, ", ")) : "\n\n";
  text += table.introduction.empty() ? "" : folded(table.introduction) + "\n\n";
  text += "| key | type | default | meaning |\n|---|---|---|---|\n";
  for (std::size_t i = 0; i < table.keys.size(); ++i) {
    const KeyReference& key = table.keys[i];
    text +=
        fmt::format("| `{}` | {} |{}|{}|\n", key.name, key.type, cell(table.defaults[i]), cell(key.meaning));
  }
  return text;
}

// ---- The files

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int write_or_check(const std::string& program, bool check) {
  std::vector<Keys> of_kinds;
  std::vector<Table> tables;
  for (const HeadKind* kind : head_kinds()) {
    of_kinds.push_back(describe_config(*kind));
    add_tables(of_kinds.back(), "", "", std::string(kind->type()), tables);
  }
  const std::filesystem::path source = SONARD_SOURCE_DIR;
  const std::filesystem::path page = source / "docs/configuration.md";
  std::string text = read(page);
  const std::size_t kept = text.find(beginning);
  if (kept == std::string::npos) {
    fmt::print("{} has no line at which the reference begins (expected {})", page.string(), beginning);
    return 1;
  }
  text.resize(kept + beginning.size());
  for (const Table& table : tables) {
    text += text_of(table, of_kinds.size());
  }
  int unlike = 0;
  for (const auto& [file, wanted] :
       {std::pair(source / "configs/schema/sonard.schema.json", schema_of(of_kinds)),
        std::pair(page, text)}) {
    if (!check) {
      std::ofstream(file, std::ios::binary) << wanted;
    } else if (read(file) != wanted) {
      fmt::print("{} is out of date: run {}\n", file.string(), program);
      ++unlike;
    }
  }
  return unlike;
}

}  // namespace
}  // namespace sonard::server

int main(int argc, char** argv) {
  return sonard::server::write_or_check(argv[0], argc > 1 && std::strcmp(argv[1], "--check") == 0);
}
