// SPDX-License-Identifier: Apache-2.0
// What configs/schema/sonard.schema.json and docs/configuration.md say of a key. YamlSection fills it in from
// the line that reads the key.
#pragma once

#include <string>
#include <vector>

namespace sonard::server {

/// What the schema and docs/configuration.md say of a key.
struct KeyReference {
  std::string name;
  std::string type;    ///< for people: "0 to 50", "`hold`, `silence`"
  std::string schema;  ///< JSON Schema of the value without its braces; empty for mappings and lists of them
  std::string default_text;  ///< for people: "500", "`hold`"; empty where there is nothing to say
  std::string default_json;  ///< "500", "\"hold\""; empty where there is none, or none that is a value
  std::string meaning;       ///< a phrase, with links of Markdown
  bool required = false;
  bool is_list = false;            ///< of mappings
  std::string introduction;        ///< of a mapping: sentences on all of it
  std::vector<KeyReference> keys;  ///< of a mapping, or of each mapping of a list
};

}  // namespace sonard::server
