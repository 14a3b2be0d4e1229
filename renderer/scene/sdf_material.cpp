// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_material.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "renderer/scene/materials.hpp"
#include "renderer/scene/sdf_parser.hpp"

namespace sonard::render {
namespace {

constexpr const char* material_element = "sonard:material";
constexpr const char* water_surface_element = "sonard:water_surface_z";
constexpr const char* sonar_attribute = "sonard:type";
constexpr std::array<std::string_view, 5> material_numbers{
    "reflectance", "lambert_mu_db", "pressure_reflection", "rms_slope", "rms_height_mm"};
constexpr std::array<std::string_view, 4> material_parents{"visual", "collision", "link", "model"};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blank);
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

double number(const std::string& text, const char* what) {
  const std::string_view digits = trimmed(text);
  double value = 0.0;
  const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || rest != digits.data() + digits.size() || !std::isfinite(value)) {
    throw WorldError(fmt::format("{} '{}': expected a number", what, text));
  }
  return value;
}

std::string text_of(const sdf::ElementPtr& element) {
  return element->GetValue() ? std::string(trimmed(element->GetValue()->GetAsString())) : std::string();
}

std::optional<double> attribute(const sdf::ElementPtr& element, const char* key) {
  if (!element->HasAttribute(key)) {
    return std::nullopt;
  }
  return number(element->GetAttribute(key)->GetAsString(), key);
}

void check_attributes(const sdf::ElementPtr& element, std::span<const std::string_view> allowed) {
  for (const auto& given : element->GetAttributes()) {
    const std::string key = given->GetKey();
    if (!key.starts_with("xmlns") && std::find(allowed.begin(), allowed.end(), key) == allowed.end()) {
      throw WorldError(fmt::format("{}: <{}> has no attribute '{}'; besides its text it may have: {}",
                                   place_of(element), element->GetName(), key, fmt::join(allowed, ", ")));
    }
  }
}

void check_own_element(const sdf::ElementPtr& element, const std::string& parent) {
  const std::string& name = element->GetName();
  if (name == material_element) {
    if (std::find(material_parents.begin(), material_parents.end(), parent) == material_parents.end()) {
      throw WorldError(fmt::format("{}: <{}> inside <{}>: it belongs in one of: {}", place_of(element), name,
                                   parent, fmt::join(material_parents, ", ")));
    }
    check_attributes(element, material_numbers);
  } else if (name == water_surface_element) {
    if (parent != "world") {
      throw WorldError(
          fmt::format("{}: <{}> inside <{}>: it belongs in <world>", place_of(element), name, parent));
    }
    check_attributes(element, {});  // the height is its text
  } else {
    throw WorldError(fmt::format("{}: unknown element <{}>; there are <{}> and <{}>", place_of(element), name,
                                 material_element, water_surface_element));
  }
  if (element->GetNextElement(name)) {
    throw WorldError(fmt::format("{}: <{}> is given twice in <{}>", place_of(element), name, parent));
  }
}

void check_own_attributes(const sdf::ElementPtr& element) {
  for (const auto& given : element->GetAttributes()) {
    const std::string key = given->GetKey();
    if (!key.starts_with("sonard:")) {
      continue;
    }
    const auto parent = element->GetParent();
    if (key != sonar_attribute || element->GetName() != "sensor" || !parent || parent->GetName() != "link" ||
        element->Get<std::string>("type") != "custom") {
      throw WorldError(
          fmt::format("{}: attribute '{}' of <{}>: there is only {}, of a <sensor type=\"custom\"> "
                      "in a <link>",
                      place_of(element), key, element->GetName(), sonar_attribute));
    }
  }
}

}  // namespace

void check_own_elements(const sdf::ElementPtr& root) {
  check_own_attributes(root);
  for (auto child = root->GetFirstElement(); child; child = child->GetNextElement()) {
    if (child->GetName().starts_with("sonard:")) {
      check_own_element(child, root->GetName());
    }
    check_own_elements(child);
  }
}

std::optional<AcousticMaterial> own_material(const sdf::ElementPtr& element,
                                             std::vector<std::string>& warnings) {
  const auto given = element->FindElement(material_element);
  if (!given) {
    return std::nullopt;
  }
  const MaterialRequest request{text_of(given),
                                attribute(given, "reflectance"),
                                attribute(given, "lambert_mu_db"),
                                attribute(given, "pressure_reflection"),
                                attribute(given, "rms_slope"),
                                attribute(given, "rms_height_mm")};
  if (request.name.empty() &&
      std::none_of(material_numbers.begin(), material_numbers.end(),
                   [&](std::string_view key) { return given->HasAttribute(std::string(key)); })) {
    throw WorldError(fmt::format("<{}> is empty: expected a name, or one of the attributes {}",
                                 material_element, fmt::join(material_numbers, ", ")));
  }
  std::vector<std::string> remarks;
  AcousticMaterial material = make_acoustic_material(request, remarks);
  for (const std::string& remark : remarks) {
    warnings.push_back(fmt::format("{}: {}", place_of(given), remark));
  }
  return material;
}

std::optional<AcousticMaterial> inherited_material(const sdf::ElementPtr& element,
                                                   std::vector<std::string>& warnings) {
  for (auto around = element->GetParent(); around; around = around->GetParent()) {
    try {
      if (auto material = own_material(around, warnings)) {
        return material;
      }
    } catch (const WorldError& error) {
      throw WorldError(fmt::format("from <{}> at {}: {}", around->GetName(), place_of(around), error.what()));
    }
  }
  return std::nullopt;
}

std::optional<double> water_surface_z_m(const sdf::ElementPtr& world) {
  const auto given = world->FindElement(water_surface_element);
  if (!given) {
    return std::nullopt;
  }
  try {
    return number(text_of(given), water_surface_element);
  } catch (const WorldError& error) {
    throw WorldError(fmt::format("{}: {}", place_of(given), error.what()));
  }
}

std::optional<std::string> sonar_type(const sdf::ElementPtr& element) {
  if (element->GetName() != "sensor" || !element->HasAttribute(sonar_attribute)) {
    return std::nullopt;
  }
  return element->GetAttribute(sonar_attribute)->GetAsString();
}

}  // namespace sonard::render
