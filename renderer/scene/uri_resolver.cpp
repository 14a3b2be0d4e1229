// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/uri_resolver.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/text/lower_case.hpp"
#include "common/text/printable.hpp"
#include "renderer/scene/fuel_cache.hpp"
#include "renderer/scene/local_file.hpp"
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

/// Refuses links that lead out of `folder`, because an archive may contain some.
std::optional<fs::path> existing_below(const fs::path& path, const fs::path& folder) {
  const auto found = existing(path);
  const auto around = existing(folder);
  return found && around && lies_below(*found, *around) ? found : std::nullopt;
}

/// A path from a URI without slashes before it: "model:///post" means "model://post". An absolute path would
/// replace the folder that it is appended to.
std::string_view without_leading_slashes(std::string_view path) {
  path.remove_prefix(std::min(path.find_first_not_of('/'), path.size()));
  return path;
}

bool lies_below_any(const fs::path& path, const std::vector<fs::path>& folders) {
  return std::ranges::any_of(folders, [&](const fs::path& folder) { return lies_below(path, folder); });
}

}  // namespace

std::vector<fs::path> model_folders_from_environment() {
  std::vector<fs::path> folders;
  for (const std::string_view variable :
       {"GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH",
        "SDF_PATH", "GZ_FILE_PATH", "IGN_FILE_PATH"}) {
    const char* value = std::getenv(variable.data());  // NOLINT(concurrency-mt-unsafe): at start-up
    std::istringstream entries(value == nullptr ? "" : value);
    for (std::string entry; std::getline(entries, entry, ':');) {
      if (entry.empty()) {
        continue;
      }
      folders.emplace_back(entry);
      if (variable == "GAZEBO_RESOURCE_PATH") {
        for (const char* media : {"media", "Media"}) {
          if (existing_below(fs::path(entry) / media, entry)) {
            folders.push_back(fs::path(entry) / media);
          }
        }
      }
    }
  }
  // Gazebo Classic stores downloaded models here.
  if (const char* home = std::getenv("HOME")) {  // NOLINT(concurrency-mt-unsafe): at start-up
    if (const fs::path models = fs::path(home) / ".gazebo/models"; existing(models)) {
      folders.push_back(models);
    }
  }
  return folders;
}

UriResolver::UriResolver(const fs::path& world_file, const std::vector<fs::path>& model_folders) {
  const fs::path folder = fs::absolute(world_file).parent_path();
  const auto add = [&](const std::optional<fs::path>& found) {
    if (found) {
      roots_.push_back(*found);
      add_model_folder(*found);
    }
  };
  add(existing(folder));
  add(existing_below(folder / "models", folder));
  add(existing_below(folder.parent_path() / "models", folder.parent_path()));
  for (const fs::path& named : model_folders) {
    add(existing(named));
    if (!existing(named) && std::ranges::find(absent_, named) == absent_.end()) {
      absent_.push_back(named);
    }
  }
  if (const auto meshes = existing_below(folder.parent_path() / "meshes", folder.parent_path())) {
    roots_.push_back(*meshes);
  }
}

void UriResolver::add_model_folder(const fs::path& folder) {
  const auto found = existing(folder);
  if (found && lies_below_any(*found, roots_) &&
      std::find(search_list_.begin(), search_list_.end(), *found) == search_list_.end()) {
    search_list_.push_back(*found);
  }
}

void UriResolver::name_model(const std::string& name, const fs::path& folder) {
  named_[lower_case(name)] = folder;
}

fs::path UriResolver::resolve_model(const std::string& uri, std::string_view rest) const {
  rest = without_leading_slashes(rest);
  const std::size_t end = std::min(rest.find('/'), rest.size());
  // A model may refer to its neighbours: "model://NAME/../OTHER/mesh.stl".
  if (const auto named = named_.find(lower_case(rest.substr(0, end))); named != named_.end()) {
    const fs::path path = named->second / without_leading_slashes(rest.substr(end));
    if (existing(path)) {
      return allowed(uri, path, named->second);
    }
  }
  return search(uri, rest, search_list_);
}

fs::path UriResolver::search(const std::string& uri, std::string_view rest,
                             const std::vector<fs::path>& folders) const {
  std::optional<WorldError> leads_out;
  for (const fs::path& folder : folders) {
    if (!existing(folder / rest)) {
      continue;
    }
    try {
      return allowed(uri, folder / rest, folder);
    } catch (const WorldError& error) {
      leads_out = leads_out ? leads_out : error;
    }
  }
  if (leads_out) {
    throw WorldError(*leads_out);
  }
  for (const fs::path& folder : folders) {
    if (const std::string trouble = trouble_reaching(folder / rest); !trouble.empty()) {
      throw MissingFile(trouble);
    }
  }
  throw MissingFile(
      fmt::format("'{}' not found; looked in {}{}; to search other folders, set GZ_SIM_RESOURCE_PATH", uri,
                  list(folders), absent_.empty() ? "" : "; these folders do not exist: " + list(absent_)));
}

/// Returns an existing path, canonical, if neither its name nor its links lead out of the folders.
fs::path UriResolver::allowed(const std::string& uri, const fs::path& path,
                              const fs::path& naming_folder) const {
  check_place(uri, path, naming_folder);
  const fs::path canonical = fs::canonical(path);
  check_place(uri, canonical, naming_folder);
  return canonical;
}

void UriResolver::check_place(const std::string& uri, const fs::path& path,
                              const fs::path& naming_folder) const {
  const fs::path place = path.lexically_normal();
  if (!lies_below(place, naming_folder) && !lies_below_any(place, roots_)) {
    throw WorldError(fmt::format(
        "'{}' leads out of the folders of this world and its models, to {}; to permit it, add its "
        "folder to GZ_SIM_RESOURCE_PATH",
        uri, printable(place.string())));
  }
}

fs::path UriResolver::resolve(const std::string& uri, const fs::path& naming_folder) const {
  if (uri.empty() || uri == "__default__") {
    throw MissingFile("the URI is missing");
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
        fmt::format("'{}': sonard downloads nothing; download it and use model:// or a path "
                    "(GZ_SIM_RESOURCE_PATH lists folders of models)",
                    uri));
  }
  if (fs::path(rest).is_absolute()) {
    if (!existing(rest)) {  // a path of another machine, perhaps
      const std::string trouble = trouble_reaching(rest);
      throw MissingFile(trouble.empty() ? fmt::format("'{}' not found", uri) : trouble);
    }
    return allowed(uri, rest, naming_folder);
  }
  std::vector<fs::path> folders{naming_folder};
  std::ranges::copy_if(search_list_, std::back_inserter(folders),
                       [&](const fs::path& folder) { return folder != naming_folder; });
  return search(uri, rest, folders);
}

}  // namespace sonard::render
