// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/collada_asset.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <regex>
#include <system_error>

#include <fmt/format.h>

#include "renderer/scene/local_file.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

std::string without_comments(std::string xml) {
  for (std::size_t begin = xml.find("<!--"); begin != std::string::npos; begin = xml.find("<!--", begin)) {
    const std::size_t end = xml.find("-->", begin + 4);
    xml.erase(begin, end == std::string::npos ? std::string::npos : end + 3 - begin);
  }
  return xml;
}

/// The text of the first <asset>, which belongs to the document as a whole.
std::string asset_of(const std::filesystem::path& file) {
  std::string head = head_of(file, 65536);
  std::erase(head, '\0');  // the second halves of UTF-16 characters in tags
  head = without_comments(std::move(head));
  const std::size_t begin = head.find("<asset");
  return begin == std::string::npos ? "" : head.substr(begin, head.find("</asset>", begin) - begin);
}

double unit_m_of(const std::string& asset) {
  static const std::regex attribute(R"RE(<unit\s[^>]*\bmeter\s*=\s*["']\s*([^"'\s]*)\s*["'])RE");
  std::smatch match;
  if (!std::regex_search(asset, match, attribute)) {
    return 1.0;
  }
  std::string text = match[1].str();
  std::ranges::replace(text, ',', '.');  // some exporters write a decimal comma, depending on the locale
  double metres = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), metres);
  if (error != std::errc() || rest != text.data() + text.size() || !std::isfinite(metres) || metres <= 0.0) {
    throw WorldError(fmt::format("<unit meter=\"{}\">: expected a number > 0", match[1].str()));
  }
  return metres;
}

}  // namespace

ColladaAsset read_collada_asset(const std::filesystem::path& file) {
  const std::string asset = asset_of(file);
  static const std::regex up_axis(R"RE(<up_axis\s*>\s*([XYZ]_UP)\s*<)RE");
  std::smatch match;
  return {unit_m_of(asset), std::regex_search(asset, match, up_axis) ? match[1].str() : ""};
}

}  // namespace sonard::render
