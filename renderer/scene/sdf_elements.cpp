// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_elements.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace sonard::render {
namespace {

using Names = std::set<std::string_view>;

/// Children of the elements that sonard reads, by the specification (sdformat.org/spec) from 1.3 to 1.12.
/// Contents of other elements are not checked.
const std::map<std::string_view, Names>& known_children() {
  static const std::map<std::string_view, Names> children{
      {"sdf", {"world", "model", "actor", "light", "include"}},
      {"world", {"audio",      "wind",
                 "gravity",    "magnetic_field",
                 "atmosphere", "gui",
                 "physics",    "scene",
                 "light",      "model",
                 "actor",      "plugin",
                 "road",       "spherical_coordinates",
                 "state",      "population",
                 "include",    "frame",
                 "joint",      "particle_emitter"}},
      {"include", {"uri", "name", "pose", "static", "placement_frame", "plugin"}},
      {"model",
       {"static", "self_collide", "allow_auto_disable", "include", "model", "enable_wind", "frame", "pose",
        "link", "joint", "plugin", "gripper"}},
      {"link",
       {"gravity", "enable_wind", "self_collide", "kinematic", "must_be_base_link", "velocity_decay", "frame",
        "pose", "inertial", "collision", "visual", "sensor", "projector", "audio_sink", "audio_source",
        "battery", "light", "particle_emitter"}},
      {"visual",
       {"cast_shadows", "laser_retro", "transparency", "visibility_flags", "meta", "frame", "pose",
        "material", "geometry", "plugin"}},
      {"collision",
       {"laser_retro", "max_contacts", "frame", "pose", "geometry", "surface", "density",
        "auto_inertia_params"}},
      {"geometry",
       {"empty", "box", "capsule", "cone", "cylinder", "ellipsoid", "heightmap", "image", "mesh", "plane",
        "polyline", "sphere"}},
      {"box", {"size"}},
      {"capsule", {"radius", "length"}},
      {"cone", {"radius", "length"}},
      {"cylinder", {"radius", "length"}},
      {"ellipsoid", {"radii"}},
      {"heightmap", {"uri", "size", "pos", "texture", "blend", "use_terrain_paging", "sampling"}},
      {"mesh", {"uri", "submesh", "scale", "convex_decomposition"}},
      {"submesh", {"name", "center"}},
      {"plane", {"normal", "size"}},
      {"sphere", {"radius"}},
  };
  return children;
}

struct Unknown {
  std::string place;  ///< of the first one
  std::size_t count = 0;
};
using UnknownByKind = std::map<std::pair<std::string, std::string>, Unknown>;  ///< key: parent, name

void find_unknown(const SdfElement& element, UnknownByKind& found) {
  if (!known_children().contains(element.name)) {
    return;
  }
  for (const auto& child : element.children) {
    if (is_known_child(element.name, child->name)) {
      find_unknown(*child, found);
    } else if (Unknown& kind = found[{element.name, child->name}]; kind.count++ == 0) {
      kind.place = child->place();
    }
  }
}

}  // namespace

bool is_known_child(std::string_view parent, std::string_view child) {
  const auto known = known_children().find(parent);
  return known == known_children().end() || child.find(':') != std::string_view::npos ||
         known->second.contains(child);
}

std::vector<std::string> unknown_elements(const SdfElement& sdf) {
  UnknownByKind found;
  find_unknown(sdf, found);
  std::vector<std::string> lines;
  for (const auto& [kind, unknown] : found) {
    lines.push_back(fmt::format("{}: unknown element <{}> in <{}>: it is left out{}{}", unknown.place,
                                kind.second, kind.first,
                                kind.second == "material" ? "; for a sonar, write <sonard:material>" : "",
                                unknown.count > 1 ? fmt::format(" ({} times in all)", unknown.count) : ""));
  }
  return lines;
}

}  // namespace sonard::render
