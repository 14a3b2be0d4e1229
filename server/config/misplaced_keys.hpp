// SPDX-License-Identifier: Apache-2.0
// Unknown keys that belong in another section.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/config/config_error.hpp"
#include "server/config/key_reference.hpp"

namespace sonard::server {

/// An unknown key, and the problem that reports it.
struct UnknownKey {
  std::size_t problem = 0;  ///< index
  std::string name;         ///< "multipath"
  bool has_value = false;   ///< a word or number, not a mapping or list
};

/// Adds the right section to the message of each unknown key whose name is a key of exactly one other
/// section: "unknown key here, did you mean 'acoustics.physical.multipath.level'? (...)".
/// @param known keys of the whole file, one list for each kind of head
void name_sections(std::vector<ConfigProblem>& problems, std::span<const UnknownKey> unknown,
                   std::span<const std::vector<KeyReference>> known);

}  // namespace sonard::server
