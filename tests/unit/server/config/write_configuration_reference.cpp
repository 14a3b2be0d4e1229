// SPDX-License-Identifier: Apache-2.0
// Writes configs/schema/sonard.schema.json and the reference in docs/configuration.md from the loader's keys,
// and the tables in docs/events.md from the counters of devices and transports.
// With --check it only reports whether these files are up to date.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "server/config/loader.hpp"
#include "server/devices/types/types.hpp"
#include "tests/unit/server/config/events_reference.hpp"

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

/// Documents differ only in `heads`, their last key, because each head is of one of the types.
std::string schema_of(const std::vector<Keys>& of_types) {
  Keys document = of_types.front();
  std::string heads;
  for (const Keys& keys : of_types) {
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

struct Row {
  KeyReference key;      ///< its name is the path below the mapping of the table: "tcp[].bind"
  std::string defaults;  ///< default, and types with another default
};

struct Table {
  std::vector<std::string> paths;  ///< paths of the mappings with these keys: "heads[].mount"
  std::vector<std::string> types;  ///< types of heads with these mappings
  std::string introduction;
  std::vector<Row> rows;
};

std::string default_of(const KeyReference& key) {
  return key.required ? "**required**" : key.default_text;
}

bool same_but_for_defaults(const Row& one, const Row& other) {
  return one.key.name == other.key.name && one.key.type == other.key.type &&
         one.key.meaning == other.key.meaning && one.key.required == other.key.required;
}

void add_once(std::vector<std::string>& list, const std::string& text) {
  if (std::find(list.begin(), list.end(), text) == list.end()) {
    list.push_back(text);
  }
}

std::string path_of(const std::string& path, const KeyReference& key) {
  return (path.empty() ? "" : path + ".") + key.name + (key.is_list ? "[]" : "");
}

/// A small mapping gets no table of its own: its keys follow its row.
bool is_small(const KeyReference& key) {
  constexpr std::size_t most_keys = 4;
  return !key.keys.empty() && key.keys.size() <= most_keys;
}

/// Adds rows for keys and for the keys of small mappings in them.
void add_rows(const Keys& keys, const std::string& path, std::vector<Row>& rows) {
  for (const KeyReference& key : keys) {
    const bool merged = is_small(key);
    Row row = {key, default_of(key)};
    row.key.name = path_of(path, key);
    if (!merged && key.is_list) {
      row.key.name.resize(row.key.name.size() - 2);
    }
    if (merged && !key.introduction.empty()) {
      row.key.meaning += ". " + key.introduction;
      row.key.meaning.erase(row.key.meaning.find_last_not_of('.') + 1);
    }
    rows.push_back(row);
    if (merged) {
      add_rows(key.keys, row.key.name, rows);
    }
  }
}

void add_defaults(Table& table, const std::vector<Row>& rows, const std::string& type) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string other = fmt::format("; {}: {}", type, rows[i].defaults);
    if (rows[i].defaults != default_of(table.rows[i].key) && !table.rows[i].defaults.ends_with(other)) {
      table.rows[i].defaults += other;
    }
  }
}

void add_inner_tables(const Keys& keys, const std::string& path, const std::string& type,
                      std::vector<Table>& tables);

/// Adds a mapping and all mappings inside it. If a table has the same keys, the mapping joins this table.
void add_tables(const Keys& keys, const std::string& path, const std::string& introduction,
                const std::string& type, std::vector<Table>& tables) {
  std::vector<Row> rows;
  add_rows(keys, "", rows);
  auto table = std::find_if(tables.begin(), tables.end(), [&](const Table& other) {
    return other.introduction == introduction &&
           std::equal(other.rows.begin(), other.rows.end(), rows.begin(), rows.end(), same_but_for_defaults);
  });
  if (table == tables.end()) {
    table = tables.insert(table, {{}, {}, introduction, rows});
  }
  add_once(table->paths, path);
  add_once(table->types, type);
  add_defaults(*table, rows, type);
  add_inner_tables(keys, path, type, tables);
}

void add_inner_tables(const Keys& keys, const std::string& path, const std::string& type,
                      std::vector<Table>& tables) {
  for (const KeyReference& key : keys) {
    if (is_small(key)) {
      add_inner_tables(key.keys, path_of(path, key), type, tables);
    } else if (!key.keys.empty()) {
      add_tables(key.keys, path_of(path, key), key.introduction, type, tables);
    }
  }
}

std::vector<Row>::iterator find_row(Table& table, const Row& row) {
  return std::find_if(table.rows.begin(), table.rows.end(),
                      [&](const Row& other) { return same_but_for_defaults(row, other); });
}

/// The rows that all of these tables have, with the defaults of each.
std::vector<Row> common_rows(std::vector<Table>& tables, const std::vector<std::size_t>& places) {
  std::vector<Row> common;
  for (Row row : tables[places.front()].rows) {
    const std::string first = row.defaults;
    const bool everywhere = std::all_of(places.begin(), places.end(), [&](std::size_t place) {
      const auto other = find_row(tables[place], row);
      if (other == tables[place].rows.end()) {
        return false;
      }
      row.defaults += other->defaults == first
                          ? ""
                          : fmt::format("; {}: {}", tables[place].types.front(), other->defaults);
      return true;
    });
    if (everywhere) {
      common.push_back(row);
    }
  }
  return common;
}

/// Moves rows that these tables share to a table of their own, in front of the first, if it is worth a table.
void share_rows(std::vector<Table>& tables, const std::vector<std::size_t>& places) {
  constexpr std::size_t least_rows = 4;
  Table shared = {tables[places.front()].paths, {}, "", common_rows(tables, places)};
  if (places.size() < 2 || shared.rows.size() < least_rows) {
    return;
  }
  for (const std::size_t place : places) {
    shared.types.push_back(tables[place].types.front());
    for (const Row& row : shared.rows) {
      tables[place].rows.erase(find_row(tables[place], row));
    }
  }
  tables.insert(tables.begin() + static_cast<std::ptrdiff_t>(places.front()), shared);
}

/// The tables of one type for mappings with this path.
std::vector<std::size_t> places_of(const std::vector<Table>& tables, const std::string& path) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (tables[i].paths.front() == path && tables[i].types.size() == 1) {
      places.push_back(i);
    }
  }
  return places;
}

void share_rows_of(std::vector<Table>& tables, const std::string& path) {
  share_rows(tables, places_of(tables, path));
  const std::size_t count = places_of(tables, path).size();
  for (std::size_t one = 0; one < count; ++one) {
    for (std::size_t other = one + 1; other < count; ++other) {
      for (std::size_t third = other + 1; third < count; ++third) {
        const std::vector<std::size_t> places = places_of(tables, path);
        share_rows(tables, {places.at(one), places.at(other), places.at(third)});
      }
    }
  }
  for (std::size_t one = 0; one < count; ++one) {
    for (std::size_t other = one + 1; other < count; ++other) {
      const std::vector<std::size_t> places = places_of(tables, path);
      share_rows(tables, {places.at(one), places.at(other)});
    }
  }
}

/// Tables of all types come first, then those of the first type.
std::size_t order_of(const Table& table, const std::vector<std::string>& types) {
  return table.types.size() == types.size()
             ? 0
             : 1 + static_cast<std::size_t>(std::find(types.begin(), types.end(), table.types.front()) -
                                            types.begin());
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

std::string text_of(const Table& table, std::size_t type_count) {
  std::string text = table.paths.front().empty() ? "\n### Top level"
                                                 : fmt::format("\n### `{}`", fmt::join(table.paths, "`, `"));
  text += table.types.size() < type_count ? fmt::format(" ({})\n", fmt::join(table.types, ", ")) : "\n";
  text += table.introduction.empty() ? "" : folded(table.introduction) + "\n\n";
  text += "| key | type | default | meaning |\n|---|---|---|---|\n";
  for (const auto& [key, defaults] : table.rows) {
    text += fmt::format("| `{}` | {} |{}|{}|\n", key.name, key.type, cell(defaults), cell(key.meaning));
  }
  return text;
}

// ---- The files

constexpr std::string_view beginning_of_events =
    "<!-- From here to the end written by write_configuration_reference, from counts() of devices and "
    "transports -->\n";

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The page with `reference` in place of all that follows the line `begin`.
std::string page_with(const std::filesystem::path& page, std::string_view begin,
                      const std::string& reference) {
  std::string text = read(page);
  const std::size_t kept = text.find(begin);
  if (kept == std::string::npos) {
    throw std::runtime_error(
        fmt::format("{} has no line at which the reference begins (expected {})", page.string(), begin));
  }
  text.resize(kept + begin.size());
  return text + reference;
}

int write_or_check(const std::string& program, bool check) {
  std::vector<Keys> of_types;
  std::vector<std::string> types;
  std::vector<Table> tables;
  for (const HeadType* type : head_types()) {
    types.emplace_back(type->name());
    of_types.push_back(describe_config(*type));
    add_tables(of_types.back(), "", "", types.back(), tables);
  }
  for (const char* path : {"heads[]", "heads[].acoustics"}) {
    share_rows_of(tables, path);
  }
  std::stable_sort(tables.begin(), tables.end(), [&](const Table& one, const Table& other) {
    return order_of(one, types) < order_of(other, types);
  });
  const std::filesystem::path source = SONARD_SOURCE_DIR;
  std::string reference;
  for (const Table& table : tables) {
    reference += text_of(table, of_types.size());
  }
  const std::filesystem::path keys = source / "docs/configuration.md";
  const std::filesystem::path events = source / "docs/events.md";
  int unlike = 0;
  for (const auto& [file, wanted] :
       {std::pair(source / "configs/schema/sonard.schema.json", schema_of(of_types)),
        std::pair(keys, page_with(keys, beginning, reference)),
        std::pair(events, page_with(events, beginning_of_events, events_reference()))}) {
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
  try {
    return sonard::server::write_or_check(argv[0], argc > 1 && std::strcmp(argv[1], "--check") == 0);
  } catch (const std::runtime_error& error) {
    fmt::print("{}", error.what());
    return 1;
  }
}
