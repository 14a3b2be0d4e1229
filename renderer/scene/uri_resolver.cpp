// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/uri_resolver.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

#include "renderer/scene/fuel_cache.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> existing(const fs::path& path) {
  std::error_code error;
  fs::path canonical = fs::canonical(path, error);
  if (error) {
    return std::nullopt;
  }
  return canonical;
}

std::string list(const std::vector<fs::path>& folders) {
  std::vector<std::string> names;
  names.reserve(folders.size());
  for (const fs::path& folder : folders) {
    names.push_back(folder.string());
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Both absolute.
bool lies_below(const fs::path& path, const fs::path& folder) {
  const auto differs = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first;
  return !folder.empty() && differs == folder.end();
}

bool lies_below_any(const fs::path& path, const std::vector<fs::path>& folders) {
  return std::ranges::any_of(folders, [&](const fs::path& folder) { return lies_below(path, folder); });
}

}  // namespace

std::vector<fs::path> model_folders_from_environment() {
  std::vector<fs::path> folders;
  for (const char* variable :
       {"GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "SDF_PATH"}) {
    const char* value = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe): at start-up, nothing sets it
    std::istringstream entries(value == nullptr ? "" : value);
    for (std::string entry; std::getline(entries, entry, ':');) {
      if (!entry.empty()) {
        folders.emplace_back(entry);
      }
    }
  }
  return folders;
}

UriResolver::UriResolver(const fs::path& world_file, const std::vector<fs::path>& model_folders) {
  const fs::path folder = fs::absolute(world_file).parent_path();
  std::vector<fs::path> candidates{folder, folder / "models", folder.parent_path() / "models"};
  candidates.insert(candidates.end(), model_folders.begin(), model_folders.end());
  for (const fs::path& candidate : candidates) {
    if (const auto found = existing(candidate)) {
      roots_.push_back(*found);
      add_model_folder(*found);
    }
  }
  if (const auto meshes = existing(folder.parent_path() / "meshes")) {
    roots_.push_back(*meshes);
  }
}

void UriResolver::add_model_folder(const fs::path& folder) {
  const auto found = existing(folder);
  if (found && lies_below_any(*found, roots_) &&
      std::find(model_folders_.begin(), model_folders_.end(), *found) == model_folders_.end()) {
    model_folders_.push_back(*found);
  }
}

void UriResolver::name_model(const std::string& name, const fs::path& folder) {
  named_[lower_case(name)] = folder;
}

fs::path UriResolver::resolve_model(const std::string& uri, std::string_view rest) const {
  const std::size_t end = std::min(rest.find('/'), rest.size());
  // A model may name its neighbours: "model://NAME/../OTHER/mesh.stl".
  if (const auto named = named_.find(lower_case(rest.substr(0, end))); named != named_.end()) {
    const fs::path path = named->second / rest.substr(std::min(end + 1, rest.size()));
    if (const auto found = existing(path)) {
      check_place(uri, path, named->second);
      check_place(uri, *found, named->second);
      return *found;
    }
  }
  for (const fs::path& folder : model_folders_) {
    if (const auto found = existing(folder / rest)) {
      check_place(uri, folder / rest, folder);
      check_place(uri, *found, folder);
      return *found;
    }
  }
  throw MissingFile(fmt::format("'{}' not found; looked in {}", uri, list(model_folders_)));
}

void UriResolver::check_place(const std::string& uri, const fs::path& path,
                              const fs::path& naming_folder) const {
  const fs::path place = path.lexically_normal();
  if (!lies_below(place, naming_folder) && !lies_below_any(place, roots_)) {
    throw WorldError(
        fmt::format("'{}' leads out of the folders of this world and its models, to {}; name its folder in "
                    "GZ_SIM_RESOURCE_PATH if it may be read",
                    uri, place.string()));
  }
}

fs::path UriResolver::resolve(const std::string& uri, const fs::path& naming_folder) const {
  if (uri.empty() || uri == "__default__") {
    throw WorldError("the URI is missing");
  }
  const std::size_t colon = uri.find("://");
  const std::string scheme = colon == std::string::npos ? "" : uri.substr(0, colon);
  const std::string rest = colon == std::string::npos ? uri : uri.substr(colon + 3);
  if (scheme == "model" || scheme == "package") {
    return resolve_model(uri, rest);
  }
  if (const auto fuel = parse_fuel_uri(uri)) {
    return resolve_in_fuel_cache(uri, *fuel);
  }
  if (!scheme.empty() && scheme != "file") {
    throw MissingFile(
        fmt::format("'{}': nothing is fetched from a network; download it and use model:// or a path "
                    "(GZ_SIM_RESOURCE_PATH names "
                    "folders of models)",
                    uri));
  }
  const fs::path path = naming_folder / rest;  // an absolute `rest` wins
  check_place(uri, path, naming_folder);
  if (const auto found = existing(path)) {
    check_place(uri, *found, naming_folder);  // where links lead
    return *found;
  }
  throw MissingFile(fmt::format("'{}' not found; looked for {}", uri, path.lexically_normal().string()));
}

}  // namespace sonard::render
