// SPDX-License-Identifier: Apache-2.0
// What an SDF file has and a world has not: one line for each kind of it.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "renderer/scene/sdf_tree.hpp"

namespace sonard::render {

class LeftOut {
 public:
  /// Lights, plugins, joints, actors, other sensors, ...: all elements that no part of a world is made of.
  void add_elements_of(const SdfElement& root);
  /// A shape of a kind that is not drawn, "polyline".
  void add_geometry(const std::string& kind, const std::string& path);
  /// Something that no element of those above is, in the form of silent(): "models without shapes", "marks".
  void add_silent(std::string_view what, std::string name) { add(what, false, std::move(name)); }

  /// "lights (2): sun, lamp": nothing that echoes.
  std::vector<std::string> silent() const { return lines(false); }
  /// What has a surface, or might have one, in the same form.
  std::vector<std::string> audible() const { return lines(true); }

 private:
  struct Kind {
    std::string what;  ///< "lights"
    bool audible = false;
    std::vector<std::string> names;
  };

  void add(std::string_view what, bool audible, std::string name);
  void add_children_of(const SdfElement& element, const std::string& path);
  std::vector<std::string> lines(bool audible) const;

  std::vector<Kind> kinds_;  // in the order in which they came
};

}  // namespace sonard::render
