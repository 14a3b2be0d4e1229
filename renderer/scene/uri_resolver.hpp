// SPDX-License-Identifier: Apache-2.0
// Resolves a URI in a world file to a local path.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Advice for a MissingFile that ends the loading.
inline constexpr std::string_view how_to_skip =
    "; correct it, or load the world without it: `world: {missing: skip}`";

/// A file named in a world is missing, or lacks the requested part.
struct MissingFile : WorldError {
  using WorldError::WorldError;
};

/// Searches the files that a world names. Never accesses a network, nor files outside the given folders,
/// because worlds can be untrusted.
class UriResolver {
 public:
  /// The search list is the folder of `world_file`, `models/` in it, `models/` beside it, then
  /// `model_folders`. Files may lie below these, and in `meshes/` beside the world's folder.
  UriResolver(const std::filesystem::path& world_file,
              const std::vector<std::filesystem::path>& model_folders);

  /// Appends a folder of models, found while loading, to the search list, if it lies below the given folders.
  void add_model_folder(const std::filesystem::path& folder);

  /// `model://NAME/...` is first searched in this folder of a model.
  void name_model(const std::string& name, const std::filesystem::path& folder);

  /// @param uri `model://NAME/REST` or `package://NAME/REST`, searched in the search list; a bare name, a
  /// relative path or `file://` with one, searched in `naming_folder` (the folder of the file with the URI)
  /// and then in the search list; an absolute path; or a model of Fuel
  /// (`https://fuel.gazebosim.org/1.0/OWNER/models/NAME/VERSION`), searched in Gazebo's local cache.
  /// @return an existing file or folder, canonical.
  /// @throws MissingFile with the folders searched, if no such file exists; WorldError if the URI is invalid,
  /// or names an existing file outside of `naming_folder` and all folders of models. Links are followed:
  /// their targets count.
  std::filesystem::path resolve(const std::string& uri, const std::filesystem::path& naming_folder) const;

  /// Folders below which files of the world and its models may lie; canonical.
  const std::vector<std::filesystem::path>& folders() const { return roots_; }

  /// @throws WorldError if `path`, the result for `uri`, is outside of `naming_folder` and all folders of
  /// models
  void check_place(const std::string& uri, const std::filesystem::path& path,
                   const std::filesystem::path& naming_folder) const;

 private:
  std::filesystem::path resolve_model(const std::string& uri, std::string_view rest) const;
  std::filesystem::path search(const std::string& uri, std::string_view rest,
                               const std::vector<std::filesystem::path>& folders) const;
  std::filesystem::path allowed(const std::string& uri, const std::filesystem::path& path,
                                const std::filesystem::path& naming_folder) const;

  std::vector<std::filesystem::path> roots_;  ///< files may lie below these
  std::vector<std::filesystem::path> search_list_;
  std::vector<std::filesystem::path> absent_;  ///< folders that the caller gave but that do not exist
  std::map<std::string, std::filesystem::path, std::less<>> named_;  ///< key in lower case
};

}  // namespace sonard::render
