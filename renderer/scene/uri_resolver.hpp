// SPDX-License-Identifier: Apache-2.0
// From a URI in a world file to a local path.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sonard::render {

/// Where the files that a world names are looked for. Never touches a network.
class UriResolver {
 public:
  /// Looks for `model://NAME/...` in the folder of `world_file`, in `models/` there, beside it (`../models`),
  /// and then in `model_folders`.
  UriResolver(const std::filesystem::path& world_file,
              const std::vector<std::filesystem::path>& model_folders);

  /// A folder that holds models, found while loading: `model://` is looked for there too.
  void add_model_folder(const std::filesystem::path& folder);

  /// @param uri `model://NAME/REST`, `package://NAME/REST`, `file://PATH`, an absolute path, or a path
  /// relative to `naming_folder`, the folder of the file that names it.
  /// @return an existing file or folder, canonical.
  /// @throws WorldError saying where it was looked for, or that the scheme needs a network.
  std::filesystem::path resolve(const std::string& uri, const std::filesystem::path& naming_folder) const;

 private:
  std::vector<std::filesystem::path> model_folders_;
};

}  // namespace sonard::render
