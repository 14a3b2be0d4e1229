// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_tree.hpp"

#include <strings.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

#include <fmt/format.h>

#include "renderer/scene/world.hpp"

namespace sonard::render {

const std::string* SdfElement::attribute(std::string_view key) const {
  const auto given = std::ranges::find(attributes, key, &std::pair<std::string, std::string>::first);
  return given == attributes.end() ? nullptr : &given->second;
}

void SdfElement::set_attribute(std::string_view key, std::string value) {
  std::erase_if(attributes, [&](const auto& given) { return given.first == key; });
  attributes.emplace_back(key, std::move(value));
}

const SdfElement* SdfElement::child(std::string_view child_name) const {
  const auto found =
      std::ranges::find(children, child_name, [](const auto& one) -> std::string_view { return one->name; });
  return found == children.end() ? nullptr : found->get();
}

SdfElement* SdfElement::child(std::string_view child_name) {
  return const_cast<SdfElement*>(std::as_const(*this).child(child_name));
}

SdfElement& SdfElement::add_child(std::string child_name, const SdfElement& from) {
  children.push_back(std::make_unique<SdfElement>());
  SdfElement& added = *children.back();
  added.name = std::move(child_name);
  added.file = from.file;
  added.line = from.line;
  added.parent = this;
  return added;
}

SdfElement& SdfElement::add_copy(const SdfElement& from) {
  SdfElement& added = add_child(from.name, from);
  added.text = from.text;
  added.attributes = from.attributes;
  return added;
}

std::string SdfElement::given_name() const {
  const std::string* const given = attribute("name");
  return given == nullptr ? std::string() : *given;
}

std::string SdfElement::place() const {
  return fmt::format("{}:{}", file->string(), line);
}

bool is_own_namespace(std::string_view uri) {
  return uri == own_namespace || uri == "urn:sonard";
}

bool is_true(const std::string* attribute) {
  return attribute != nullptr && (strcasecmp(attribute->c_str(), "true") == 0 || *attribute == "1");
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blank);
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

double number(std::string_view text, std::string_view what) {
  std::string_view digits = trimmed(text);
  digits.remove_prefix(digits.starts_with('+') ? 1 : 0);
  double value = 0.0;
  const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || rest != digits.data() + digits.size()) {
    throw WorldError(fmt::format("{} '{}': expected a number", what, text));
  }
  if (!std::isfinite(value)) {
    throw WorldError(fmt::format("{} '{}': expected a finite number", what, text));
  }
  return value;
}

std::vector<double> numbers_of(const SdfElement* element, const std::vector<double>& otherwise) {
  if (element == nullptr) {
    return otherwise;
  }
  std::vector<double> numbers;
  std::string_view rest = element->text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find_first_of(" \t\r\n"), rest.size());
    numbers.push_back(number(rest.substr(0, end), element->name));
    rest = trimmed(rest.substr(end));
  }
  if (numbers.size() != otherwise.size()) {
    throw WorldError(fmt::format("{} '{}': expected {} number{}", element->name, element->text,
                                 otherwise.size(), otherwise.size() == 1 ? "" : "s"));
  }
  return numbers;
}

void WorldProblems::add(std::string line) {
  constexpr std::size_t most = 1000;
  if (lines_.size() <= most && known_.insert(line).second) {
    lines_.push_back(lines_.size() < most ? std::move(line) : "more problems are not shown");
  }
}

}  // namespace sonard::render
