// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/collada_counts.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tinyxml2.h>

namespace sonard::render {
namespace {

using tinyxml2::XMLElement;

/// The whole numbers in the element's text; other words count as 0.
std::vector<std::uint64_t> numbers_in(const XMLElement* element) {
  const char* const text = element == nullptr ? nullptr : element->GetText();
  std::istringstream words(text == nullptr ? "" : text);
  std::vector<std::uint64_t> numbers;
  for (std::string word; words >> word;) {
    std::from_chars(word.data(), word.data() + word.size(), numbers.emplace_back(0));
  }
  return numbers;
}

/// Number of indices per corner: one for each offset.
std::uint64_t indices_of_a_corner(const XMLElement& primitives) {
  unsigned int most = 0;
  for (const auto* input = primitives.FirstChildElement("input"); input != nullptr;
       input = input->NextSiblingElement("input")) {
    most = std::max(most, input->UnsignedAttribute("offset"));
  }
  return std::uint64_t{most} + 1;
}

void require(const XMLElement& element, std::uint64_t promised, std::uint64_t there, std::string_view what) {
  if (there < promised) {
    throw std::runtime_error(fmt::format("line {}: <{}> declares {} {}, there are {}", element.GetLineNum(),
                                         element.Name(), promised, what, there));
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
      const std::vector<std::uint64_t> corners = numbers_in(element.FirstChildElement("vcount"));
      require(element, count, corners.size(), "polygons");
      const std::uint64_t all = std::accumulate(corners.begin(), corners.end(), std::uint64_t{0});
      require(element, all * indices_of_a_corner(element), numbers_in(element.FirstChildElement("p")).size(),
              "indices");
    }
    return true;
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
