// SPDX-License-Identifier: Apache-2.0
// Collects warnings that repeat for each visual of a world into one line per kind.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace sonard::render {

class GroupedWarnings {
 public:
  /// @param kind the problem and its remedy, for all of them: "mesh materials are not acoustic ones: ..."
  /// @param place "file:line"; the line shows the first place
  /// @param name the affected element: "'RedPaint' (m::l::v)"; each is listed once
  void add(const std::string& kind, const std::string& place, const std::string& name);

  /// "file:line: KIND (12): NAME, NAME, ..." for each kind.
  std::vector<std::string> lines() const;

 private:
  struct Group {
    std::string place;
    std::vector<std::string> first;  ///< names that are shown
    std::set<std::string> names;
  };
  std::map<std::string, Group> groups_;
};

}  // namespace sonard::render
