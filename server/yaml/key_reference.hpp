// SPDX-License-Identifier: Apache-2.0
// The entry of a key in configs/schema/sonard.schema.json and docs/configuration.md. YamlSection fills it in
// from the line that reads the key.
#pragma once

#include <string>
#include <vector>

namespace sonard::server {

/// The entry of a key in the schema and in docs/configuration.md.
struct KeyReference {
  std::string name;
  std::string type;    ///< for people: "0 to 50", "`hold`, `silence`"
  std::string schema;  ///< JSON Schema of the value without its braces; empty for mappings and lists of them
  std::string default_text;  ///< for people: "500", "`hold`"; empty if there is no text
  std::string default_json;  ///< "500", "\"hold\""; empty if the default is missing or no value
  std::string meaning;       ///< a phrase, with links of Markdown
  bool required = false;
  bool is_list = false;            ///< a list of mappings
  std::string introduction;        ///< sentences that describe a whole mapping
  std::vector<KeyReference> keys;  ///< of a mapping, or of each mapping of a list
};

}  // namespace sonard::server
