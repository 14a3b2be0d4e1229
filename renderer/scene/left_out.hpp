// SPDX-License-Identifier: Apache-2.0
// Collects the elements of an SDF file that are not in the world: one line for each kind.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "renderer/scene/sdf_tree.hpp"

namespace sonard::render {

class LeftOut {
 public:
  /// Lights, plugins, joints, actors, other sensors, ...: all elements that do not become part of a world.
  void add_elements_of(const SdfElement& root);
  /// A shape of a kind that is not supported, "polyline".
  void add_geometry(const std::string& kind, const std::string& path);
  /// Something else without an echo, for silent(): "models without shapes", "marks".
  void add_silent(std::string_view what, std::string name) { add(what, false, std::move(name)); }

  /// The elements without an echo, "lights (2): sun, lamp".
  std::vector<std::string> silent() const { return lines(false); }
  /// The elements that have a surface, or might have one, in this form.
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

  std::vector<Kind> kinds_;  // in the order of their first element
};

}  // namespace sonard::render
