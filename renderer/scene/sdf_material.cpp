// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_material.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/text/edit_distance.hpp"
#include "common/text/lower_case.hpp"
#include "renderer/scene/materials.hpp"

namespace sonard::render {
namespace {

constexpr const char* material_element = "sonard:material";
constexpr const char* water_surface_element = "sonard:water_surface_z";
constexpr const char* sonar_attribute = "sonard:type";
constexpr std::array<std::string_view, 5> material_numbers{
    "reflectance", "lambert_mu_db", "pressure_reflection", "rms_slope", "rms_height_mm"};
constexpr std::array<std::string_view, 4> material_parents{"visual", "collision", "link", "model"};
constexpr std::array own_elements{material_element, water_surface_element};
constexpr std::array own_attributes{sonar_attribute};
constexpr const char* expected_attribute = "sonard:type, of a <sensor type=\"custom\"> in a <link>";

/// Where an own element belongs: "<world>".
std::string parents_of(std::string_view own_element) {
  return own_element == material_element ? fmt::format("one of: {}", fmt::join(material_parents, ", "))
                                         : "<world>";
}

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

/// The own name that a name without its prefix is equal or similar to, in any case; or empty.
std::string similar_own_name(std::string_view local, std::span<const char* const> own_names) {
  const std::string name = "sonard:" + lower_case(local);
  const std::size_t most = std::max<std::size_t>(1, local.size() / 3);
  for (const char* const own : own_names) {
    if (edit_distance(name, own) <= most) {
      return own;
    }
  }
  return "";
}

void check_own_element(const SdfElement& element, WorldProblems& problems) {
  const SdfElement& parent = *element.parent;
  const auto complain = [&](const std::string& message) {
    problems.add(fmt::format("{}: {}", element.place(), message));
  };
  if (element.name == material_element) {
    if (std::ranges::find(material_parents, parent.name) == material_parents.end()) {
      complain(fmt::format("<{}> inside <{}>: it belongs in {}", element.name, parent.name,
                           parents_of(element.name)));
    }
    check_attributes(element, material_numbers, problems);
  } else if (element.name == water_surface_element) {
    if (parent.name != "world") {
      complain(fmt::format("<{}> inside <{}>: it belongs in {}", element.name, parent.name,
                           parents_of(element.name)));
    }
    check_attributes(element, {}, problems);  // its text is the height
  } else {
    const std::string own = similar_own_name(
        std::string_view(element.name).substr(std::string_view("sonard:").size()), own_elements);
    complain(own.empty() ? fmt::format("unknown element <{}>; expected <{}>", element.name,
                                       fmt::join(own_elements, "> or <"))
                         : fmt::format("unknown element <{}>: write <{}>", element.name, own));
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
      problems.add(fmt::format("{}: attribute '{}' of <{}> is not supported; expected {}", element.place(),
                               key, element.name, expected_attribute));
    }
  }
}

/// A name with a prefix that is not ours.
struct ForeignName {
  std::string_view prefix, local;
  bool looks_like_sonard() const { return lower_case(prefix).starts_with("sonar"); }
};

/// nullopt: the name has no prefix, or ours, or one of XML.
std::optional<ForeignName> foreign_name(std::string_view name) {
  const std::size_t colon = name.find(':');
  if (colon == std::string_view::npos) {
    return std::nullopt;
  }
  const ForeignName parts{name.substr(0, colon), name.substr(colon + 1)};
  const bool is_known = parts.prefix == "sonard" || parts.prefix == "xml" || parts.prefix == "xmlns";
  return is_known ? std::nullopt : std::optional(parts);
}

/// The error of an element or attribute that looks like ours, with advice; empty if it belongs to another
/// program.
std::string advice_for(const ForeignName& name, bool is_attribute) {
  const std::string similar = is_attribute ? similar_own_name(name.local, own_attributes)
                                           : similar_own_name(name.local, own_elements);
  const std::string meant = is_attribute ? similar : fmt::format("<{}>", similar);
  const std::string own = "sonard:" + lower_case(name.local);
  if (own != similar && !name.looks_like_sonard()) {
    return "";
  }
  if (similar.empty()) {
    return fmt::format("prefix and name are not sonard's; expected {}",
                       is_attribute ? std::string(expected_attribute)
                                    : fmt::format("<{}>", fmt::join(own_elements, "> or <")));
  }
  return similar == fmt::format("sonard:{}", name.local)
             ? fmt::format("its prefix is not sonard's; write {}, or declare xmlns:{}=\"{}\" in <sdf>", meant,
                           name.prefix, own_namespace)
             : fmt::format("prefix and name are not sonard's; write {}", meant);
}

bool may_have_material(const SdfElement& element) {
  return std::ranges::find(material_parents, element.name) != material_parents.end();
}

constexpr std::size_t longest_name = 100;

/// True for <material>mud</material> in a visual; in others, unknown_elements() names it. Gazebo's own
/// <material> has children and no text; names of its former scripts have a slash, as in Gazebo/Grey.
bool is_material_without_prefix(const SdfElement& element) {
  return element.name == "material" && element.parent != nullptr && element.parent->name == "visual" &&
         element.children.empty() && !element.text.empty() && element.text.size() <= longest_name &&
         element.text.find('/') == std::string::npos;
}

/// The error of an attribute that gives a material, as in <visual acoustics:material="mud">; empty for
/// others.
std::string advice_for_material_attribute(const SdfElement& element, std::string_view local) {
  return may_have_material(element) && lower_case(local) == "material"
             ? fmt::format("a material is an element; write <{0}>...</{0}> into <{1}>", material_element,
                           element.name)
             : "";
}

struct LookAlike {
  std::string line;  ///< about the first one
  std::size_t count = 0;
};

/// Collects the kinds of elements and attributes that look like ours.
class LookAlikes {
 public:
  void find_in(const SdfElement& element) {
    if (const auto name = foreign_name(element.name)) {
      add(element, fmt::format("<{}>", element.name), advice_for(*name, false));
    }
    if (is_material_without_prefix(element)) {
      add(element, "<material> with a text in <visual>",
          fmt::format("Gazebo's <material> has no text; write <{0}>{1}</{0}> for a sonar", material_element,
                      element.text));
    }
    for (const auto& [key, value] : element.attributes) {
      const auto name = foreign_name(key);
      const std::string material =
          advice_for_material_attribute(element, name ? name->local : std::string_view(key));
      if (!material.empty()) {
        add(element, fmt::format("attribute {} of <{}>", key, element.name), material);
      } else if (name && (element.name == "sensor" || name->looks_like_sonard())) {
        add(element, fmt::format("attribute {} of <{}>", key, element.name), advice_for(*name, true));
      }
    }
    for (const auto& child : element.children) {
      if (element.name == "plugin") {
        find_in_plugin(*child);
      } else {
        find_in(*child);
      }
    }
  }

  const std::map<std::string, LookAlike>& found() const { return found_; }

 private:
  /// Elements of a plugin belong to it, unless both prefix and name look like ours.
  void find_in_plugin(const SdfElement& element) {
    const auto name = foreign_name(element.name);
    const std::string own =
        name && name->looks_like_sonard() ? similar_own_name(name->local, own_elements) : "";
    add(element, fmt::format("<{}> in a <plugin>", element.name),
        own.empty() ? "" : fmt::format("write <{}> into {}", own, parents_of(own)));
    for (const auto& child : element.children) {
      find_in_plugin(*child);
    }
  }

  void add(const SdfElement& element, const std::string& what, const std::string& advice) {
    if (advice.empty()) {
      return;
    }
    LookAlike& kind = found_[what];
    if (kind.count++ == 0) {
      kind.line = fmt::format("{}: {} is left out: {}", element.place(), what, advice);
    }
  }

  std::map<std::string, LookAlike> found_;
};

}  // namespace

std::vector<std::string> look_alikes(const SdfElement& root) {
  LookAlikes look_alikes;
  look_alikes.find_in(root);
  std::vector<std::string> lines;
  for (const auto& [what, kind] : look_alikes.found()) {
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
