// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/left_out.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "renderer/scene/sdf_material.hpp"

namespace sonard::render {
namespace {

constexpr std::size_t most_names = 6;

struct ElementKind {
  std::string_view element;
  std::string_view what;
  bool audible = false;
};

// Elements of the SDF specification. Elements inside them are not read.
constexpr std::array<ElementKind, 18> element_kinds{{
    {"actor", "actors", true},
    {"road", "roads", true},
    {"population", "populations", true},
    {"particle_emitter", "particle emitters"},
    {"light", "lights"},
    {"plugin", "plugins"},
    {"sensor", "sensors of other kinds"},
    {"joint", "joints, which do not move here"},
    {"gripper", "grippers"},
    {"projector", "projectors"},
    {"battery", "batteries"},
    {"physics", "physics"},
    {"scene", "scene"},
    {"gui", "gui"},
    {"audio", "audio"},
    {"wind", "wind"},
    {"atmosphere", "atmosphere"},
    {"magnetic_field", "magnetic field"},
}};

std::string described(const SdfElement& element, const std::string& path) {
  const std::string* const type = element.name == "sensor" ? element.attribute("type") : nullptr;
  return path + element.given_name() + (type == nullptr ? "" : fmt::format(" ({})", *type));
}

}  // namespace

void LeftOut::add_elements_of(const SdfElement& root) {
  add_children_of(root, "");
}

void LeftOut::add_geometry(const std::string& kind, const std::string& path) {
  add(fmt::format("shapes of geometry <{}>", kind), true, path);
}

void LeftOut::add_children_of(const SdfElement& element, const std::string& path) {
  for (const auto& child : element.children) {
    if (sonar_type(*child) || child->name == "state") {
      continue;
    }
    const auto kind = std::ranges::find(element_kinds, child->name, &ElementKind::element);
    if (kind != element_kinds.end()) {
      add(kind->what, kind->audible, described(*child, path));
      continue;
    }
    const bool named = child->name == "model" || child->name == "link";
    add_children_of(*child, named ? path + child->given_name() + "::" : path);
  }
}

void LeftOut::add(std::string_view what, bool audible, std::string name) {
  auto kind =
      std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& known) { return known.what == what; });
  if (kind == kinds_.end()) {
    kind = kinds_.insert(kind, {std::string(what), audible, {}});
  }
  kind->names.push_back(std::move(name));
}

std::vector<std::string> LeftOut::lines(bool audible) const {
  std::vector<std::string> result;
  for (const Kind& kind : kinds_) {
    if (kind.audible != audible) {
      continue;
    }
    std::vector<std::string> names;
    std::copy_if(kind.names.begin(), kind.names.end(), std::back_inserter(names),
                 [](const std::string& name) { return !name.empty(); });
    const bool more = names.size() > most_names;
    names.resize(std::min(names.size(), most_names));
    result.push_back(fmt::format("{} ({}){}{}{}", kind.what, kind.names.size(), names.empty() ? "" : ": ",
                                 fmt::join(names, ", "), more ? ", ..." : ""));
  }
  return result;
}

}  // namespace sonard::render
