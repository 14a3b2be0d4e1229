// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/collada_for_assimp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <tinyxml2.h>

namespace sonard::render {
namespace {

using tinyxml2::XMLElement;

std::string_view name_of(const XMLElement* element) {
  return element == nullptr ? "" : element->Name();
}

/// Children of these names, each in the order of the file.
std::vector<XMLElement*> children_of(XMLElement& element, const std::vector<const char*>& names) {
  std::vector<XMLElement*> children;
  for (const char* const name : names) {
    for (auto* child = element.FirstChildElement(name); child != nullptr;
         child = child->NextSiblingElement(name)) {
      children.push_back(child);
    }
  }
  return children;
}

class Mender : public tinyxml2::XMLVisitor {
 public:
  /// Collects the elements to mend, because a visitor must not change the document.
  bool VisitEnter(const XMLElement& element, const tinyxml2::XMLAttribute*) override {
    const std::string_view name = element.Name();
    in_mesh_ += name == "mesh" ? 1 : 0;
    const bool is_unused = name == "library_images" || name == "effect";
    if ((name == "accessor" && in_mesh_ > 0) || name == "node" || is_unused) {
      found_.push_back(const_cast<XMLElement*>(&element));
    }
    return !is_unused;  // its children are deleted
  }
  bool VisitExit(const XMLElement& element) override {
    in_mesh_ -= name_of(&element) == "mesh" ? 1 : 0;
    return true;
  }

  /// @return whether anything was changed
  bool mend() {
    for (XMLElement* const element : found_) {
      const std::string_view name = element->Name();
      if (name == "accessor") {
        name_values(*element);
      } else if (name == "node") {
        order_transforms(*element);
      } else {
        changed_ = changed_ || element->FirstChild() != nullptr;
        element->DeleteChildren();
      }
    }
    return changed_;
  }

 private:
  void name_values(XMLElement& accessor) {
    constexpr std::array<const char*, 4> names{"X", "Y", "Z", "A"};  // Assimp's names for the values 0 to 3
    constexpr std::array<const char*, 4> texture_names{"S", "T", "P", "A"};
    constexpr std::array<const char*, 4> colour_names{"R", "G", "B", "A"};
    const unsigned int values = std::min(accessor.UnsignedAttribute("stride", 1), 4U);
    XMLElement* parameter = accessor.FirstChildElement("param");
    for (unsigned int i = 0; i < values; ++i) {
      if (parameter == nullptr) {
        parameter = accessor.InsertNewChildElement("param");
        parameter->SetAttribute("type", "float");
      }
      const char* const given = parameter->Attribute("name");
      const std::string_view known = given == nullptr ? "" : given;
      if (known != names[i] && known != texture_names[i] && known != colour_names[i]) {
        parameter->SetAttribute("name", names[i]);
        changed_ = true;
      }
      parameter = parameter->NextSiblingElement("param");
    }
  }

  void order_transforms(XMLElement& node) {
    const std::vector<const char*> kinds{"matrix", "translate", "rotate", "scale", "skew", "lookat"};
    std::vector<XMLElement*> wanted = children_of(node, {"matrix"});
    if (wanted.empty()) {
      wanted = children_of(node, {"translate", "rotate", "scale"});
    }
    const auto repeats = [&](const XMLElement* transform) {
      const std::string_view name = transform->Name();
      return name != "rotate" && transform != node.FirstChildElement(transform->Name());
    };
    std::erase_if(wanted, repeats);
    std::ranges::for_each(wanted, [&](XMLElement* transform) { make_unit_axis(*transform); });
    std::vector<XMLElement*> given;
    for (auto* child = node.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      if (std::ranges::find(kinds, name_of(child)) != kinds.end()) {
        given.push_back(child);
      }
    }
    if (given == wanted) {
      return;
    }
    changed_ = true;
    for (XMLElement* const transform : given) {
      if (std::ranges::find(wanted, transform) == wanted.end()) {
        node.DeleteChild(transform);
      }
    }
    std::ranges::for_each(wanted.rbegin(), wanted.rend(),
                          [&](XMLElement* transform) { node.InsertFirstChild(transform); });
  }

  /// Gazebo turns by the angle about the direction of the axis, whatever its length, and not at all about an
  /// axis of zeros. Assimp takes the axis as it is, which scales.
  void make_unit_axis(XMLElement& transform) {
    if (name_of(&transform) != "rotate" || transform.GetText() == nullptr) {
      return;
    }
    std::istringstream text(transform.GetText());
    text.imbue(std::locale::classic());
    double x = 0, y = 0, z = 0, angle_deg = 0;
    if (!(text >> x >> y >> z >> angle_deg)) {
      return;
    }
    const double length = std::hypot(x, y, z);
    if (std::abs(length - 1) < 1e-6 || !std::isfinite(length)) {
      return;
    }
    transform.SetText(length > 0
                          ? fmt::format("{} {} {} {}", x / length, y / length, z / length, angle_deg).c_str()
                          : "1 0 0 0");
    changed_ = true;
  }

  std::vector<XMLElement*> found_;
  int in_mesh_ = 0;
  bool changed_ = false;
};

}  // namespace

std::string collada_for_assimp(std::string document) {
  tinyxml2::XMLDocument xml;
  if (xml.Parse(document.data(), document.size()) != tinyxml2::XML_SUCCESS) {
    return document;
  }
  Mender mender;
  xml.Accept(&mender);
  if (!mender.mend()) {
    return document;
  }
  tinyxml2::XMLPrinter printer(nullptr, true);
  xml.Print(&printer);
  return printer.CStr();
}

}  // namespace sonard::render
