// SPDX-License-Identifier: Apache-2.0
// The loader, docs/configuration.md and the JSON Schema know the same keys, and loader and schema the same
// values.
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "server/devices/kinds/kinds.hpp"
#include "tests/unit/config/config_text.hpp"

namespace sonard::server {
namespace {

const std::string source_folder = SONARD_SOURCE_DIR;

/// The schema, walked with references resolved, for heads of one type. JSON is YAML, so the YAML parser reads
/// it.
class Schema {
 public:
  explicit Schema(std::string head_type)
      : root_(YAML::LoadFile(source_folder + "/configs/schema/sonard.schema.json")),
        head_type_(std::move(head_type)) {
    visit(root_, "");
  }

  /// Every key by its path ("heads[].network.bind"), with what the schema says of it.
  const std::map<std::string, YAML::Node>& keys() const { return keys_; }
  /// Every mapping by its path, "" for the document, with the names of its keys.
  const std::map<std::string, std::set<std::string>>& mappings() const { return mappings_; }
  const std::set<std::string>& open_mappings() const { return open_mappings_; }

  /// A configuration that gives every key there is a value that suits none, and one key too many in every
  /// mapping.
  std::string nonsense() const { return nonsense_of(root_); }

 private:
  YAML::Node resolved(const YAML::Node& node) const {
    if (node["$ref"]) {
      const std::string prefix = "#/$defs/";
      return resolved(root_["$defs"][node["$ref"].as<std::string>().substr(prefix.size())]);
    }
    if (node["oneOf"]) {
      for (const auto& alternative : node["oneOf"]) {
        const YAML::Node head = resolved(alternative);
        if (head["properties"]["type"]["const"].as<std::string>() == head_type_) {
          return head;
        }
      }
    }
    return node;
  }
  /// Of a list of mappings; undefined for anything else.
  YAML::Node items(const YAML::Node& node) const {
    const YAML::Node each = node["items"] ? resolved(node["items"]) : YAML::Node(YAML::NodeType::Undefined);
    return each.IsDefined() && each["properties"] ? each : YAML::Node(YAML::NodeType::Undefined);
  }

  void visit(const YAML::Node& unresolved, const std::string& path) {
    const YAML::Node node = resolved(unresolved);
    if (const YAML::Node each = items(node); each.IsDefined()) {
      visit(each, path + "[]");
    }
    if (!node["properties"]) {
      return;
    }
    mappings_[path];
    if (!node["additionalProperties"] || node["additionalProperties"].as<bool>()) {
      open_mappings_.insert(path);
    }
    for (const auto& property : node["properties"]) {
      const std::string name = property.first.as<std::string>();
      const std::string key = path.empty() ? name : path + "." + name;
      mappings_[path].insert(name);
      keys_.emplace(key, resolved(property.second));
      visit(property.second, key);
    }
  }

  std::string nonsense_of(const YAML::Node& unresolved) const {
    const YAML::Node node = resolved(unresolved);
    if (const YAML::Node each = items(node); each.IsDefined()) {
      return "[" + nonsense_of(each) + "]";
    }
    if (node["const"]) {
      return node["const"].as<std::string>();  // or the head would be one of another type
    }
    if (!node["properties"]) {
      return "zz";
    }
    std::string text = "{zz: zz";
    for (const auto& property : node["properties"]) {
      text += ", " + property.first.as<std::string>() + ": " + nonsense_of(property.second);
    }
    return text + "}";
  }

  YAML::Node root_;
  std::string head_type_;
  std::map<std::string, YAML::Node> keys_;
  std::map<std::string, std::set<std::string>> mappings_;
  std::set<std::string> open_mappings_;
};

/// "expected ..." as the loader should say it for a plain number, word list or boolean; empty for other
/// types.
std::string expected_text(const YAML::Node& node) {
  if (node["enum"]) {
    std::string words = "one of ";
    for (std::size_t i = 0; i < node["enum"].size(); ++i) {
      words += (i == 0 ? "" : ", ") + node["enum"][i].as<std::string>();
    }
    return words;
  }
  const std::string type = node["type"] ? node["type"].as<std::string>() : "";
  if (type == "boolean") {
    return "true or false";
  }
  if (type == "integer") {
    return fmt::format("a whole number from {} to {}", node["minimum"].as<std::string>(),
                       node["maximum"].as<std::string>());
  }
  if (type == "number") {
    const bool above = node["exclusiveMinimum"].IsDefined();
    return fmt::format("a number {} {:g} to {:g}", above ? "above" : "from",
                       node[above ? "exclusiveMinimum" : "minimum"].as<double>(),
                       node["maximum"].as<double>());
  }
  return "";
}

class Reference : public ConfigFolder, public testing::WithParamInterface<std::string> {
 protected:
  /// What the loader says about Schema::nonsense(), by key.
  std::map<std::string, std::string> complaints_by_key() {
    std::map<std::string, std::string> by_key;
    const std::regex form(R"(config\.yaml:\d+:\d+: ([^:]+): (.*))");
    for (const std::string& line : complaints(schema_.nonsense())) {
      std::smatch match;
      EXPECT_TRUE(std::regex_match(line, match, form)) << line;
      by_key[std::regex_replace(match.str(1), std::regex(R"(\[0\])"), "[]")] = match.str(2);
    }
    return by_key;
  }

  Schema schema_{GetParam()};
};

std::set<std::string> head_types() {
  std::set<std::string> types;
  for (const HeadKind* kind : head_kinds()) {
    types.emplace(kind->type());
  }
  return types;
}

INSTANTIATE_TEST_SUITE_P(HeadTypes, Reference, testing::ValuesIn(head_types()),
                         [](const auto& type) { return type.param; });

TEST(Schema, has_heads_of_the_same_types_as_the_loader) {
  const YAML::Node root = YAML::LoadFile(source_folder + "/configs/schema/sonard.schema.json");
  const std::string prefix = "#/$defs/";
  std::set<std::string> types;
  for (const auto& head : root["properties"]["heads"]["items"]["oneOf"]) {
    const YAML::Node def = root["$defs"][head["$ref"].as<std::string>().substr(prefix.size())];
    types.insert(def["properties"]["type"]["const"].as<std::string>());
  }
  EXPECT_EQ(types, head_types());
}

TEST_P(Reference, schema_and_loader_know_the_same_keys) {
  const std::map<std::string, std::string> said = complaints_by_key();
  ASSERT_GT(schema_.mappings().size(), 20U);
  EXPECT_THAT(schema_.open_mappings(), testing::IsEmpty());
  for (const auto& [path, names] : schema_.mappings()) {
    const std::string key = path.empty() ? "zz" : path + ".zz";
    ASSERT_TRUE(said.contains(key)) << key;
    std::smatch match;
    ASSERT_TRUE(std::regex_match(said.at(key), match, std::regex(R"(unknown key.*\(expected one of (.*)\))")))
        << key;
    std::set<std::string> known;
    std::istringstream list(match.str(1));
    for (std::string name; std::getline(list >> std::ws, name, ',');) {
      known.insert(name);
    }
    EXPECT_EQ(known, names) << "in '" << path << "'";
  }
}

TEST_P(Reference, schema_and_loader_take_the_same_values) {
  const std::map<std::string, std::string> said = complaints_by_key();
  int compared = 0;
  for (const auto& [key, node] : schema_.keys()) {
    const std::string expected = expected_text(node);
    if (!expected.empty()) {
      ASSERT_TRUE(said.contains(key)) << key;
      EXPECT_THAT(said.at(key), testing::HasSubstr("(expected " + expected)) << key;
      ++compared;
    }
  }
  EXPECT_GT(compared, 40);
}

TEST_P(Reference, every_key_is_documented_and_no_other) {
  std::ifstream page(source_folder + "/docs/configuration.md");
  ASSERT_TRUE(page);
  const std::regex heading(
      R"(### (.*?)(?: \((\w+)\))?)");  // the type of head in brackets, where it is of one only
  const std::regex name(R"(`([^`]+)`)");
  const std::regex row(R"(\| `([a-z0-9_]+)` \|.*)");
  std::set<std::string> documented;
  std::vector<std::string> prefixes;
  for (std::string line; std::getline(page, line);) {
    std::smatch match;
    if (std::regex_match(line, match, heading)) {
      const std::string title = match.str(1);
      prefixes.clear();
      if (match.length(2) > 0 && match.str(2) != GetParam()) {
        continue;
      }
      for (std::sregex_iterator it(title.begin(), title.end(), name), end; it != end; ++it) {
        prefixes.push_back(it->str(1) + ".");
      }
      if (prefixes.empty()) {
        prefixes.emplace_back();  // "the document"
      }
    } else if (std::regex_match(line, match, row)) {
      for (const std::string& prefix : prefixes) {
        documented.insert(prefix + match.str(1));
      }
    }
  }
  std::set<std::string> known;
  for (const auto& [key, node] : schema_.keys()) {
    known.insert(key);
  }
  EXPECT_EQ(documented, known);
}

}  // namespace
}  // namespace sonard::server
