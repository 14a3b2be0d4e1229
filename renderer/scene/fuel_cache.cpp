// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/fuel_cache.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/text/lower_case.hpp"
#include "common/text/percent_decoding.hpp"
#include "renderer/scene/uri_resolver.hpp"

namespace sonard::render {
namespace {

namespace fs = std::filesystem;

// One server with two names; caches use either name.
constexpr std::array<std::string_view, 2> hosts{"fuel.gazebosim.org", "fuel.ignitionrobotics.org"};

std::vector<std::string> segments_of(std::string_view path) {
  std::vector<std::string> segments;
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('/'), path.size());
    if (end > 0) {
      segments.push_back(percent_decoded(path.substr(0, end)));
    }
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return segments;
}

/// Whether a name leads out of its folder, after "%2F" is decoded.
bool leads_up(const std::string& name) {
  return name == ".." || name.find('/') != std::string::npos;
}

bool is_number(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::vector<fs::path> cache_folders() {
  std::vector<fs::path> folders;
  const auto add = [&](const char* variable, const char* below) {
    if (const char* value =
            std::getenv(variable)) {  // NOLINT(concurrency-mt-unsafe): at start-up, nothing sets it
      folders.push_back(fs::path(value) / below);
    }
  };
  add("GZ_FUEL_CACHE_PATH", "");
  add("IGN_FUEL_CACHE_PATH", "");
  add("HOME", ".gz/fuel");
  add("HOME", ".ignition/fuel");
  return folders;
}

/// The folder with the highest number, if any.
std::optional<fs::path> newest_version(const fs::path& model) {
  std::optional<fs::path> newest;
  int highest = -1;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(model, error)) {
    const std::string name = entry.path().filename().string();
    int version = -1;
    std::from_chars(name.data(), name.data() + name.size(), version);
    if (is_number(name) && version > highest) {
      highest = version;
      newest = entry.path();
    }
  }
  return newest;
}

}  // namespace

std::optional<FuelUri> parse_fuel_uri(std::string_view uri) {
  for (const std::string_view scheme : {"https://", "http://", "fuel://"}) {
    if (!uri.starts_with(scheme)) {
      continue;
    }
    std::vector<std::string> parts = segments_of(uri.substr(scheme.size()));
    if (parts.empty() || std::ranges::find(hosts, parts[0]) == hosts.end() ||
        std::ranges::any_of(parts, leads_up)) {
      return std::nullopt;
    }
    parts.erase(parts.begin());
    if (!parts.empty() && parts[0].find('.') != std::string::npos) {
      parts.erase(parts.begin());  // the version of Fuel's API
    }
    if (parts.size() < 3 || parts[1] != "models") {
      return std::nullopt;
    }
    FuelUri fuel{lower_case(parts[0]), lower_case(parts[2]), "", ""};
    std::size_t next = 3;
    if (next < parts.size() && (is_number(parts[next]) || parts[next] == "tip")) {
      fuel.version = parts[next++];
    }
    next += next < parts.size() && parts[next] == "files" ? 1 : 0;
    for (; next < parts.size(); ++next) {
      fuel.rest += (fuel.rest.empty() ? "" : "/") + parts[next];
    }
    return fuel;
  }
  return std::nullopt;
}

fs::path resolve_in_fuel_cache(const std::string& uri, const FuelUri& fuel) {
  std::vector<std::string> looked_in;
  for (const fs::path& cache : cache_folders()) {
    looked_in.push_back(cache.string());
    for (const std::string_view host : hosts) {
      const fs::path model = cache / host / fuel.owner / "models" / fuel.name;
      const auto version =
          is_number(fuel.version) ? std::optional(model / fuel.version) : newest_version(model);
      std::error_code error;
      if (fs::path found = version ? fs::canonical(*version / fuel.rest, error) : fs::path();
          version && !error) {
        return found;
      }
    }
  }
  throw MissingFile(
      fmt::format("'{}' is not in the local cache of Fuel; looked in {}. sonard downloads nothing; run "
                  "`gz fuel download -u {}`",
                  uri, fmt::join(looked_in, ", "), uri.substr(0, uri.find("/files/"))));
}

}  // namespace sonard::render
