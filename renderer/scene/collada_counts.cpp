// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/collada_counts.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tinyxml2.h>

namespace sonard::render {
namespace {

using tinyxml2::XMLElement;

/// The whole numbers in the element's text; other words count as 0.
std::vector<std::int64_t> numbers_in(const XMLElement* element) {
  constexpr std::string_view blanks = " \t\r\n";
  const char* const given = element == nullptr ? nullptr : element->GetText();
  std::string_view text = given == nullptr ? "" : given;
  std::vector<std::int64_t> numbers;
  while (text.find_first_not_of(blanks) != std::string_view::npos) {
    text.remove_prefix(text.find_first_not_of(blanks));
    const std::string_view word = text.substr(0, text.find_first_of(blanks));
    std::from_chars(word.data(), word.data() + word.size(), numbers.emplace_back(0));
    text.remove_prefix(word.size());
  }
  return numbers;
}

const XMLElement* input_of(const XMLElement& element, std::string_view semantic) {
  const auto* input = element.FirstChildElement("input");
  while (input != nullptr && !input->Attribute("semantic", std::string(semantic).c_str())) {
    input = input->NextSiblingElement("input");
  }
  return input;
}

/// The element called `kind` in the mesh whose id is the source of `input`, or nullptr.
const XMLElement* source_of(const XMLElement* input, const XMLElement& mesh, const char* kind) {
  const char* const url = input == nullptr ? nullptr : input->Attribute("source");
  if (url == nullptr || *url != '#') {
    return nullptr;
  }
  const auto* element = mesh.FirstChildElement(kind);
  while (element != nullptr && !element->Attribute("id", url + 1)) {
    element = element->NextSiblingElement(kind);
  }
  return element;
}

/// Number of positions that the mesh of `primitives` declares; nullopt if it declares none.
std::optional<std::int64_t> positions_of(const XMLElement& primitives) {
  const XMLElement* const mesh = primitives.Parent()->ToElement();
  const XMLElement* found =
      mesh == nullptr ? nullptr : source_of(input_of(primitives, "VERTEX"), *mesh, "vertices");
  found = found == nullptr ? nullptr : source_of(input_of(*found, "POSITION"), *mesh, "source");
  found = found == nullptr ? nullptr : found->FirstChildElement("technique_common");
  found = found == nullptr ? nullptr : found->FirstChildElement("accessor");
  std::int64_t count = 0;
  return found != nullptr && found->QueryInt64Attribute("count", &count) == tinyxml2::XML_SUCCESS
             ? std::optional(count)
             : std::nullopt;
}

/// Number of indices per corner: one for each offset.
std::size_t indices_of_a_corner(const XMLElement& primitives) {
  unsigned int most = 0;
  for (const auto* input = primitives.FirstChildElement("input"); input != nullptr;
       input = input->NextSiblingElement("input")) {
    most = std::max(most, input->UnsignedAttribute("offset"));
  }
  return std::size_t{most} + 1;
}

void require(const XMLElement& element, std::uint64_t promised, std::uint64_t there, std::string_view what) {
  if (there < promised) {
    throw std::runtime_error(fmt::format("line {}: <{}> declares {} {}, there are {}", element.GetLineNum(),
                                         element.Name(), promised, what, there));
  }
}

/// Only indices of positions: a mesh without texture coordinates or normals can be used.
void require_positions(const XMLElement& primitives, const std::vector<std::int64_t>& indices) {
  const std::optional<std::int64_t> count = positions_of(primitives);
  if (!count) {
    return;
  }
  const std::size_t step = indices_of_a_corner(primitives);
  for (std::size_t i = input_of(primitives, "VERTEX")->UnsignedAttribute("offset"); i < indices.size();
       i += step) {
    if (indices[i] < 0 || indices[i] >= *count) {
      throw std::runtime_error(fmt::format("line {}: <{}> has the index {}, there are {} vertices (from 0)",
                                           primitives.GetLineNum(), primitives.Name(), indices[i], *count));
    }
  }
}

class CountCheck : public tinyxml2::XMLVisitor {
 public:
  bool VisitEnter(const XMLElement& element, const tinyxml2::XMLAttribute*) override {
    const std::string_view name = element.Name();
    const std::uint64_t count = element.Unsigned64Attribute("count");
    if (name == "float_array") {
      require(element, count, numbers_in(&element).size(), "numbers");
    } else if (name == "triangles") {
      require(element, 3 * count * indices_of_a_corner(element),
              numbers_in(element.FirstChildElement("p")).size(), "indices");
    } else if (name == "polylist") {
      const std::vector<std::int64_t> corners = numbers_in(element.FirstChildElement("vcount"));
      require(element, count, corners.size(), "polygons");
      const auto all = std::accumulate(
          corners.begin(), corners.end(), std::uint64_t{0}, [](std::uint64_t sum, std::int64_t n) {
            return sum + static_cast<std::uint64_t>(std::max(n, std::int64_t{0}));
          });
      require(element, all * indices_of_a_corner(element), numbers_in(element.FirstChildElement("p")).size(),
              "indices");
    } else if (name == "p" || name == "h") {
      check_indices(element);
    }
    return true;
  }

 private:
  /// @param list <p>, or <p> or <h> in the <ph> of a polygon with holes
  static void check_indices(const XMLElement& list) {
    constexpr std::array<std::string_view, 5> surfaces{"triangles", "polylist", "polygons", "tristrips",
                                                       "trifans"};
    const auto* primitives = list.Parent()->ToElement();
    if (primitives != nullptr && std::string_view(primitives->Name()) == "ph") {
      primitives = primitives->Parent()->ToElement();
    }
    if (primitives != nullptr && std::ranges::find(surfaces, primitives->Name()) != surfaces.end()) {
      require_positions(*primitives, numbers_in(&list));
    }
  }
};

}  // namespace

void require_collada_counts(std::string_view document) {
  tinyxml2::XMLDocument xml;
  if (xml.Parse(document.data(), document.size()) == tinyxml2::XML_SUCCESS) {
    CountCheck check;
    xml.Accept(&check);
  }
}

}  // namespace sonard::render
