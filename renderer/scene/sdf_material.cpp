// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_material.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "renderer/scene/fuel_cache.hpp"
#include "renderer/scene/materials.hpp"

namespace sonard::render {
namespace {

constexpr const char* material_element = "sonard:material";
constexpr const char* water_surface_element = "sonard:water_surface_z";
constexpr const char* sonar_attribute = "sonard:type";
constexpr std::array<std::string_view, 5> material_numbers{
    "reflectance", "lambert_mu_db", "pressure_reflection", "rms_slope", "rms_height_mm"};
constexpr std::array<std::string_view, 4> material_parents{"visual", "collision", "link", "model"};

std::optional<double> attribute(const SdfElement& element, const char* key) {
  const std::string* const given = element.attribute(key);
  return given == nullptr ? std::nullopt : std::optional(number(*given, key));
}

void check_attributes(const SdfElement& element, std::span<const std::string_view> allowed,
                      WorldProblems& problems) {
  for (const auto& [key, value] : element.attributes) {
    if (!key.starts_with("xmlns") && std::ranges::find(allowed, key) == allowed.end()) {
      problems.add(
          fmt::format("{}: <{}> has no attribute '{}'{}{}", element.place(), element.name, key,
                      allowed.empty() ? "" : "; besides its text it may have: ", fmt::join(allowed, ", ")));
    }
  }
}

void check_own_element(const SdfElement& element, WorldProblems& problems) {
  const SdfElement& parent = *element.parent;
  const auto complain = [&](const std::string& message) {
    problems.add(fmt::format("{}: {}", element.place(), message));
  };
  if (element.name == material_element) {
    if (std::ranges::find(material_parents, parent.name) == material_parents.end()) {
      complain(fmt::format("<{}> inside <{}>: it belongs in one of: {}", element.name, parent.name,
                           fmt::join(material_parents, ", ")));
    }
    check_attributes(element, material_numbers, problems);
  } else if (element.name == water_surface_element) {
    if (parent.name != "world") {
      complain(fmt::format("<{}> inside <{}>: it belongs in <world>", element.name, parent.name));
    }
    check_attributes(element, {}, problems);  // its text is the height
  } else {
    const std::string own = lower_case(element.name);
    complain(own == material_element || own == water_surface_element
                 ? fmt::format("unknown element <{}>: write <{}>", element.name, own)
                 : fmt::format("unknown element <{}>; expected <{}> or <{}>", element.name, material_element,
                               water_surface_element));
  }
  if (parent.child(element.name) != &element) {
    complain(fmt::format("<{}> is given twice in <{}>", element.name, parent.name));
  }
}

void check_own_attributes(const SdfElement& element, WorldProblems& problems) {
  for (const auto& [key, value] : element.attributes) {
    if (!key.starts_with("sonard:")) {
      continue;
    }
    const std::string* const type = element.attribute("type");
    if (key != sonar_attribute || element.name != "sensor" || element.parent == nullptr ||
        element.parent->name != "link" || type == nullptr || *type != "custom") {
      problems.add(
          fmt::format("{}: attribute '{}' of <{}> is not supported; expected {}, of a <sensor "
                      "type=\"custom\"> in a <link>",
                      element.place(), key, element.name, sonar_attribute));
    }
  }
}

/// The name of ours that a name is probably meant to be: "sonard:material" for "sonar:Material" and
/// "x:material", "sonard:x" for "sonar:x". Empty if the name belongs to another program.
/// @param element that has the name as an attribute; empty if the name is an element's
std::string meant_name(std::string_view prefix, std::string_view local, std::string_view element) {
  const std::string own = "sonard:" + lower_case(local);
  if (element.empty() ? own == material_element || own == water_surface_element
                      : own == sonar_attribute && element == "sensor") {
    return own;
  }
  return lower_case(prefix).starts_with("sonar") ? fmt::format("sonard:{}", local) : "";
}

struct LookAlike {
  std::string line;  ///< about the first one
  std::size_t count = 0;
};

/// @param element the element called `name`, or the element with the attribute `name`
void note_look_alike(std::string_view name, const SdfElement& element, bool is_attribute,
                     std::map<std::string, LookAlike>& found) {
  const std::size_t colon = name.find(':');
  if (colon == std::string_view::npos) {
    return;
  }
  const std::string_view prefix = name.substr(0, colon);
  const std::string_view local = name.substr(colon + 1);
  const std::string meant = meant_name(prefix, local, is_attribute ? element.name : "");
  if (prefix == "sonard" || prefix == "xml" || prefix == "xmlns" || meant.empty()) {
    return;
  }
  LookAlike& kind = found[fmt::format("{} {}", is_attribute, name)];
  if (kind.count++ == 0) {
    const bool prefix_alone = meant.ends_with(fmt::format(":{}", local));
    kind.line = fmt::format(
        "{}: {} is left out: {} not sonard's; write {}{}", element.place(),
        is_attribute ? fmt::format("attribute {} of <{}>", name, element.name) : fmt::format("<{}>", name),
        prefix_alone ? "its prefix is" : "prefix and name are",
        is_attribute ? meant : fmt::format("<{}>", meant),
        prefix_alone ? fmt::format(", or declare xmlns:{}=\"{}\" in <sdf>", prefix, own_namespace) : "");
  }
}

void find_look_alikes(const SdfElement& element, std::map<std::string, LookAlike>& found) {
  note_look_alike(element.name, element, false, found);
  for (const auto& [key, value] : element.attributes) {
    note_look_alike(key, element, true, found);
  }
  for (const auto& child : element.children) {
    if (element.name != "plugin") {
      find_look_alikes(*child, found);
    }
  }
}

}  // namespace

std::vector<std::string> look_alikes(const SdfElement& root) {
  std::map<std::string, LookAlike> found;
  find_look_alikes(root, found);
  std::vector<std::string> lines;
  for (const auto& [name, kind] : found) {
    lines.push_back(kind.line + (kind.count > 1 ? fmt::format(" ({} times in all)", kind.count) : ""));
  }
  return lines;
}

void check_own_elements(const SdfElement& root, WorldProblems& problems) {
  check_own_attributes(root, problems);
  for (const auto& child : root.children) {
    if (child->name.starts_with("sonard:")) {
      check_own_element(*child, problems);
    }
    check_own_elements(*child, problems);
  }
}

std::optional<AcousticMaterial> own_material(const SdfElement& element, std::vector<std::string>& warnings) {
  const SdfElement* const given = element.child(material_element);
  if (given == nullptr) {
    return std::nullopt;
  }
  const MaterialRequest request{given->text,
                                attribute(*given, "reflectance"),
                                attribute(*given, "lambert_mu_db"),
                                attribute(*given, "pressure_reflection"),
                                attribute(*given, "rms_slope"),
                                attribute(*given, "rms_height_mm")};
  if (request.name.empty() && std::ranges::none_of(material_numbers, [&](std::string_view key) {
        return given->attribute(key) != nullptr;
      })) {
    throw WorldError(fmt::format("<{}> is empty: expected a name, or one of the attributes {}",
                                 material_element, fmt::join(material_numbers, ", ")));
  }
  std::vector<std::string> remarks;
  AcousticMaterial material = make_acoustic_material(request, remarks);
  for (const std::string& remark : remarks) {
    warnings.push_back(fmt::format("{}: {}", given->place(), remark));
  }
  return material;
}

std::optional<AcousticMaterial> inherited_material(const SdfElement& element,
                                                   std::vector<std::string>& warnings) {
  for (const SdfElement* around = element.parent; around != nullptr; around = around->parent) {
    try {
      if (auto material = own_material(*around, warnings)) {
        return material;
      }
    } catch (const WorldError& error) {
      throw WorldError(fmt::format("from <{}> at {}: {}", around->name, around->place(), error.what()));
    }
  }
  return std::nullopt;
}

std::optional<double> water_surface_z_m(const SdfElement& world) {
  const SdfElement* const given = world.child(water_surface_element);
  if (given == nullptr) {
    return std::nullopt;
  }
  try {
    return number(given->text, water_surface_element);
  } catch (const WorldError& error) {
    throw WorldError(fmt::format("{}: {}", given->place(), error.what()));
  }
}

std::optional<std::string> sonar_type(const SdfElement& element) {
  const std::string* const type = element.name == "sensor" ? element.attribute(sonar_attribute) : nullptr;
  return type == nullptr ? std::nullopt : std::optional(*type);
}

}  // namespace sonard::render
