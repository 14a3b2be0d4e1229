// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/collada_for_assimp.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cwchar>
#include <iterator>
#include <locale>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <tinyxml2.h>

namespace sonard::render {
namespace {

using tinyxml2::XMLElement;

std::string_view text_of(const XMLElement* element) {
  const char* const text = element == nullptr ? nullptr : element->GetText();
  return text == nullptr ? "" : text;
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

/// The accessor of a <source> or of other elements, or nullptr.
XMLElement* accessor_of(XMLElement* source) {
  XMLElement* const technique = source == nullptr ? nullptr : source->FirstChildElement("technique_common");
  return technique == nullptr ? nullptr : technique->FirstChildElement("accessor");
}

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
    }
    parameter = parameter->NextSiblingElement("param");
  }
}

/// Gazebo turns by the angle about the direction of the axis, whatever its length, and not at all about an
/// axis of zeros. Assimp takes the axis as it is, which scales.
void make_unit_axis(XMLElement& rotation) {
  std::istringstream text{std::string(text_of(&rotation))};
  text.imbue(std::locale::classic());
  double x = 0, y = 0, z = 0, angle_deg = 0;
  if (!(text >> x >> y >> z >> angle_deg)) {
    return;
  }
  const double length = std::hypot(x, y, z);
  if (std::abs(length - 1) < 1e-6 || !std::isfinite(length)) {
    return;
  }
  rotation.SetText(length > 0
                       ? fmt::format("{} {} {} {}", x / length, y / length, z / length, angle_deg).c_str()
                       : "1 0 0 0");
}

void order_transforms(XMLElement& node) {
  std::vector<XMLElement*> wanted = children_of(node, {"matrix"});
  if (wanted.empty()) {
    wanted = children_of(node, {"translate", "rotate", "scale"});
  }
  const auto repeats = [&](const XMLElement* transform) {
    const std::string_view name = transform->Name();
    return name != "rotate" && transform != node.FirstChildElement(transform->Name());
  };
  std::erase_if(wanted, repeats);
  for (XMLElement* const given :
       children_of(node, {"matrix", "translate", "rotate", "scale", "skew", "lookat"})) {
    if (std::ranges::find(wanted, given) == wanted.end()) {
      node.DeleteChild(given);
    }
  }
  std::ranges::for_each(wanted.rbegin(), wanted.rend(),
                        [&](XMLElement* transform) { node.InsertFirstChild(transform); });
  std::ranges::for_each(children_of(node, {"rotate"}),
                        [](XMLElement* rotation) { make_unit_axis(*rotation); });
}

/// Removes the first word from `text`, and the blanks before it. Empty if no word is left.
std::string_view next_word(std::string_view& text) {
  constexpr std::string_view blanks = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(blanks));
  text.remove_prefix(word.size());
  return word;
}

std::vector<std::int64_t> numbers_in(const XMLElement* element) {
  std::vector<std::int64_t> numbers;
  std::string_view text = text_of(element);
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text)) {
    const auto [rest, error] =
        std::from_chars(word.data(), word.data() + word.size(), numbers.emplace_back(0));
    if (error != std::errc() || rest != word.data() + word.size()) {
      throw std::runtime_error(fmt::format("line {}: <{}> has '{}' (expected whole numbers)",
                                           element->GetLineNum(), element->Name(), word.substr(0, 60)));
    }
  }
  return numbers;
}

/// The element called `kind` in the mesh whose id is the source of `input`, or nullptr.
XMLElement* source_of(const XMLElement& input, XMLElement& mesh, const char* kind) {
  const char* const url = input.Attribute("source");
  for (XMLElement* const element : children_of(mesh, {kind})) {
    if (url != nullptr && *url == '#' && element->Attribute("id", url + 1) != nullptr) {
      return element;
    }
  }
  return nullptr;
}

/// Number of values that the source of `input` declares; nullopt if it declares none.
std::optional<std::int64_t> values_of(const XMLElement& input, XMLElement& mesh) {
  if (XMLElement* const vertices = source_of(input, mesh, "vertices")) {
    for (const XMLElement* const position : children_of(*vertices, {"input"})) {
      if (position->Attribute("semantic", "POSITION") != nullptr) {
        return values_of(*position, mesh);
      }
    }
  }
  const XMLElement* const accessor = accessor_of(source_of(input, mesh, "source"));
  std::int64_t count = 0;
  return accessor != nullptr && accessor->QueryInt64Attribute("count", &count) == tinyxml2::XML_SUCCESS
             ? std::optional(count)
             : std::nullopt;
}

void require(const XMLElement& element, std::uint64_t promised, std::uint64_t there, std::string_view what) {
  if (there < promised) {
    throw std::runtime_error(fmt::format("line {}: <{}> declares {} {}, there are {}", element.GetLineNum(),
                                         element.Name(), promised, what, there));
  }
}

/// Assimp stops at words that are not numbers.
void mend_numbers(XMLElement& array) {
  std::uint64_t count = 0;
  bool is_bad = false;
  std::string mended;
  std::string_view text = text_of(&array);
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text)) {
    const bool is_number = word.find_first_not_of("0123456789+-.,eE") == std::string_view::npos;
    is_bad = is_bad || !is_number;
    mended.append(is_number ? word : "nan").append(" ");
    ++count;
  }
  require(array, array.Unsigned64Attribute("count"), count, "numbers");
  if (is_bad) {
    array.SetText(mended.c_str());
  }
}

class Surface {
 public:
  /// @param element <triangles>, <polylist>, <polygons>, <tristrips> or <trifans>
  explicit Surface(XMLElement& element) : element_(element), lists_(children_of(element, {"p"})) {
    for (XMLElement* const polygon : children_of(element, {"ph"})) {
      for (const char* const list : {"p", "h"}) {
        std::ranges::copy(children_of(*polygon, {list}), std::back_inserter(lists_));
      }
    }
    for (const XMLElement* const input : children_of(element, {"input"})) {
      step_ = std::max(step_, std::size_t{input->UnsignedAttribute("offset")} + 1);
    }
    for (const XMLElement* const list : lists_) {
      indices_.push_back(numbers_in(list));
    }
  }

  void require_counts() const {
    const std::string_view name = element_.Name();
    const std::uint64_t count = element_.Unsigned64Attribute("count");
    std::uint64_t corners = name == "triangles" ? 3 * count : 0;
    if (name == "polylist") {
      const std::vector<std::int64_t> each = numbers_in(element_.FirstChildElement("vcount"));
      require(element_, count, each.size(), "polygons");
      corners = std::accumulate(each.begin(), each.end(), corners, [](std::uint64_t sum, std::int64_t n) {
        return sum + static_cast<std::uint64_t>(std::max(n, std::int64_t{0}));
      });
    }
    require(element_, corners * step_, indices_.empty() ? 0 : indices_[0].size(), "indices");
  }

  void mend_indices(std::vector<std::string>& warnings) {
    bool is_bad = false;
    XMLElement* const mesh = element_.Parent()->ToElement();
    for (XMLElement* const input : children_of(element_, {"input"})) {
      const std::optional<std::int64_t> count = mesh == nullptr ? std::nullopt : values_of(*input, *mesh);
      const std::optional<std::int64_t> bad = count ? index_beyond(*count, *input) : std::nullopt;
      if (!bad) {
        continue;
      }
      if (input->Attribute("semantic", "VERTEX") != nullptr) {
        throw std::runtime_error(fmt::format("line {}: <{}> has the index {}, there are {} vertices (from 0)",
                                             element_.GetLineNum(), element_.Name(), *bad, *count));
      }
      warnings.push_back(fmt::format(
          "line {}: <{}> has the index {}, there are {} values in {} (from 0), which is left out; "
          "export the mesh again if it needs them",
          element_.GetLineNum(), element_.Name(), *bad, *count, input->Attribute("source")));
      element_.DeleteChild(input);
      is_bad = true;
    }
    if (is_bad) {
      drop_unused_indices();
    }
  }

 private:
  /// The first index of `input` that is not below `count`.
  std::optional<std::int64_t> index_beyond(std::int64_t count, const XMLElement& input) const {
    for (const std::vector<std::int64_t>& list : indices_) {
      for (std::size_t i = input.UnsignedAttribute("offset"); i < list.size(); i += step_) {
        if (list[i] < 0 || list[i] >= count) {
          return list[i];
        }
      }
    }
    return std::nullopt;
  }

  /// Leaves only the indices that the remaining inputs use, in the order of these inputs.
  void drop_unused_indices() {
    std::vector<std::size_t> used;
    for (XMLElement* const input : children_of(element_, {"input"})) {
      const std::size_t offset = input->UnsignedAttribute("offset");
      const auto place = std::ranges::find(used, offset);
      input->SetAttribute("offset", static_cast<int>(place - used.begin()));
      if (place == used.end()) {
        used.push_back(offset);
      }
    }
    for (std::size_t l = 0; l < lists_.size(); ++l) {
      std::string text;
      for (std::size_t corner = 0; corner + step_ <= indices_[l].size(); corner += step_) {
        for (const std::size_t offset : used) {
          text += fmt::format("{} ", indices_[l][corner + offset]);
        }
      }
      lists_[l]->SetText(text.c_str());
    }
  }

  XMLElement& element_;
  std::vector<XMLElement*> lists_;  ///< <p>, and <h> of polygons with holes
  std::vector<std::vector<std::int64_t>> indices_;
  std::size_t step_ = 1;  ///< indices per corner: one for each offset
};

std::vector<XMLElement*> controllers_in(XMLElement& root) {
  std::vector<XMLElement*> controllers;
  for (XMLElement* const library : children_of(root, {"library_controllers"})) {
    std::ranges::copy(children_of(*library, {"controller"}), std::back_inserter(controllers));
  }
  return controllers;
}

/// Puts the mesh of a skin or a morph in its place. A skin may be that of a morph.
void replace_controller(XMLElement& instance) {
  instance.SetName("instance_geometry");
  for (int pass = 0; pass < 2; ++pass) {
    for (XMLElement* const controller : controllers_in(*instance.GetDocument()->RootElement())) {
      for (const XMLElement* const of_mesh : children_of(*controller, {"skin", "morph"})) {
        const std::string id =
            std::string("#") + (controller->Attribute("id") ? controller->Attribute("id") : "");
        if (instance.Attribute("url", id.c_str()) && of_mesh->Attribute("source")) {
          instance.SetAttribute("url", of_mesh->Attribute("source"));
        }
      }
    }
  }
}

/// Mends `element` and all elements in it.
void mend(XMLElement& element, std::vector<std::string>& warnings) {
  constexpr std::array<std::string_view, 4> unused{"library_animations", "library_animation_clips",
                                                   "library_images", "effect"};
  constexpr std::array<std::string_view, 5> surfaces{"triangles", "polylist", "polygons", "tristrips",
                                                     "trifans"};
  const std::string_view name = element.Name();
  if (std::ranges::find(unused, name) != unused.end()) {
    element.DeleteChildren();
  } else if (name == "node") {
    order_transforms(element);
  } else if (name == "instance_controller") {
    replace_controller(element);
  } else if (name == "float_array") {
    mend_numbers(element);
  } else if (std::ranges::find(surfaces, name) != surfaces.end()) {
    Surface surface(element);
    surface.require_counts();
    surface.mend_indices(warnings);
  } else if (name == "mesh") {
    for (XMLElement* const source : children_of(element, {"source"})) {
      if (XMLElement* const accessor = accessor_of(source)) {
        name_values(*accessor);
      }
    }
  }
  for (auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    mend(*child, warnings);
  }
}

std::string utf8_of(std::string document) {
  const bool is_little_endian = document.starts_with("\xFF\xFE");
  if (!is_little_endian && !document.starts_with("\xFE\xFF")) {
    return document;
  }
  std::u16string units;
  for (std::size_t i = 2; i + 1 < document.size(); i += 2) {
    const auto first = static_cast<unsigned char>(document[i]),
               second = static_cast<unsigned char>(document[i + 1]);
    units += static_cast<char16_t>(is_little_endian ? second << 8U | first : first << 8U | second);
  }
  const auto& converter =
      std::use_facet<std::codecvt<char16_t, char8_t, std::mbstate_t>>(std::locale::classic());
  std::mbstate_t state{};
  const char16_t* read = nullptr;
  std::u8string utf8(3 * units.size(), u8' ');
  char8_t* written = nullptr;
  converter.out(state, units.data(), units.data() + units.size(), read, utf8.data(),
                utf8.data() + utf8.size(), written);
  return {utf8.data(), written};
}

}  // namespace

std::string collada_for_assimp(std::string document, std::vector<std::string>& warnings) {
  document = utf8_of(std::move(document));
  tinyxml2::XMLDocument xml;
  if (xml.Parse(document.data(), document.size()) != tinyxml2::XML_SUCCESS || xml.RootElement() == nullptr) {
    return document;
  }
  mend(*xml.RootElement(), warnings);
  for (XMLElement* const controller : controllers_in(*xml.RootElement())) {
    controller->Parent()->DeleteChild(controller);
  }
  tinyxml2::XMLPrinter printer(nullptr, true);
  xml.Print(&printer);
  return printer.CStr();
}

}  // namespace sonard::render
