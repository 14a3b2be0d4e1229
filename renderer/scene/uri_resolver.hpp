// SPDX-License-Identifier: Apache-2.0
// From a URI in a world file to a local path.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// A file that a world names is not there.
struct MissingFile : WorldError {
  using WorldError::WorldError;
};

/// Where the files that a world names are looked for. Never touches a network, and never a file that lies
/// outside of the folders it was given: a world may come from anywhere.
class UriResolver {
 public:
  /// Looks for `model://NAME/...` in the folder of `world_file`, in `models/` there, beside it (`../models`),
  /// and then in `model_folders`. Files may lie below these, and in `meshes/` beside the world's folder.
  UriResolver(const std::filesystem::path& world_file,
              const std::vector<std::filesystem::path>& model_folders);

  /// A folder that holds models, found while loading: `model://` is looked for there too, if it lies below
  /// the folders that were given.
  void add_model_folder(const std::filesystem::path& folder);

  /// `model://NAME/...` is looked for in this folder of a model, before all others.
  void name_model(const std::string& name, const std::filesystem::path& folder);

  /// @param uri `model://NAME/REST`, `package://NAME/REST`, `file://PATH`, an absolute path, a path relative
  /// to `naming_folder`, the folder of the file that names it, or a model of Fuel
  /// (`https://fuel.gazebosim.org/1.0/OWNER/models/NAME/VERSION`), which is looked for in Gazebo's local
  /// cache.
  /// @return an existing file or folder, canonical.
  /// @throws MissingFile saying where it was looked for; WorldError for a URI that is none, or that leads out
  /// of `naming_folder` and all folders of models. Links are followed, and where they lead counts.
  std::filesystem::path resolve(const std::string& uri, const std::filesystem::path& naming_folder) const;

  /// @throws WorldError where `path`, which `uri` has led to, is outside of `naming_folder` and all folders
  /// of models
  void check_place(const std::string& uri, const std::filesystem::path& path,
                   const std::filesystem::path& naming_folder) const;

 private:
  std::filesystem::path resolve_model(const std::string& uri, std::string_view rest) const;

  std::vector<std::filesystem::path> roots_;  ///< files may lie below these
  std::vector<std::filesystem::path> model_folders_;
  std::map<std::string, std::filesystem::path, std::less<>> named_;  ///< in lower case
};

}  // namespace sonard::render
