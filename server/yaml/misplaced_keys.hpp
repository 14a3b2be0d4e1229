// SPDX-License-Identifier: Apache-2.0
// Unknown keys that belong in another section.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/yaml/config_error.hpp"
#include "server/yaml/key_reference.hpp"

namespace sonard::server {

/// An unknown key, and the problem that reports it.
struct UnknownKey {
  std::size_t problem = 0;  ///< index
  std::string name;         ///< "multipath"
  bool has_value = false;   ///< a word or number, not a mapping or list
  std::string head_type{};  ///< of the head that holds it; empty outside of heads
};

/// A word or number in the place of a mapping, and the problem that reports it.
struct WordForMapping {
  std::size_t problem = 0;  ///< index
  std::string word;         ///< "off"
  std::string head_type{};  ///< as in UnknownKey
};

/// The keys of a file whose heads are all of one type.
struct TypeKeys {
  std::string type;  ///< of the heads, as in the configuration
  std::vector<KeyReference> keys;
};

/// Adds the right section to the message of each unknown key whose name is a key of exactly one other
/// section: "unknown key here, did you mean 'acoustics.physical.multipath.level'? (...)". In a head, only
/// keys that a head of its type may have are named; a key that another type has at this place is said to be a
/// key of that type.
/// If exactly two places in the section that holds the key are possible, both are named.
/// @param known one for each type of head
void name_sections(std::vector<ConfigProblem>& problems, std::span<const UnknownKey> unknown,
                   std::span<const TypeKeys> known);

/// Adds to the message of each word for a mapping the only key of the mapping that has this value: "is 'off'
/// (expected a mapping such as {level: off})". The missing colon of a key of this mapping is named too.
void name_keys(std::vector<ConfigProblem>& problems, std::span<const WordForMapping> words,
               std::span<const TypeKeys> known);

}  // namespace sonard::server
