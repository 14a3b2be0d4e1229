// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/mesh_readers.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <utility>
#include <vector>

#include "renderer/scene/assimp_mesh_reader.hpp"
#include "renderer/scene/complete_file.hpp"
#include "renderer/scene/isolated.hpp"
#include "renderer/scene/local_file.hpp"
#include "renderer/scene/osg_mesh_reader.hpp"
#include "renderer/scene/osg_plugin.hpp"
#include "renderer/scene/ply_reader.hpp"
#include "renderer/scene/stl_reader.hpp"

namespace sonard::render {
namespace {

struct Format {
  std::string_view extension;
  RawMesh (*read)(const MeshSource& source);
};

/// Assimp reads all formats but these:
/// - STL: Assimp 5.2 refuses keywords in capitals, and a solid without facets beside others.
/// - PLY: Assimp 5.2 takes the first bytes of some binary files for the end of the header. It crashes on
/// oil_and_gas/jumper.ply and oil_and_gas/riser_clamps.ply of configs/worlds/meshes.
/// - OpenSceneGraph's own formats: Assimp does not know them.
constexpr std::array<Format, 11> formats{{{"obj", read_with_assimp},
                                          {"stl", read_stl},
                                          {"ply", read_ply},
                                          {"dae", read_with_assimp},
                                          {"glb", read_with_assimp},
                                          {"gltf", read_with_assimp},
                                          {"fbx", read_with_assimp},
                                          {"osgt", read_with_osg},
                                          {"osgb", read_with_osg},
                                          {"ive", read_with_osg},
                                          {"3ds", read_with_assimp}}};

}  // namespace

std::span<const std::string_view> mesh_extensions() {
  static const std::vector<std::string_view> extensions = [] {
    std::vector<std::string_view> all;
    std::ranges::transform(formats, std::back_inserter(all), &Format::extension);
    return all;
  }();
  return extensions;
}

RawMesh read_mesh(const MeshSource& source) {
  const auto* const format = std::ranges::find(formats, lower_extension(source.file), &Format::extension);
  std::vector<std::filesystem::path> readable = source.folders;
  readable.push_back(source.file.parent_path());
  const IsolatedResult result = run_isolated(
      [&] {
        require_complete(source.file);
        return to_bytes(format->read(source));
      },
      reader_jail(source.file, std::move(readable)),
      [&] {
        if (format->read == read_with_osg) {
          load_osg_plugin(source.file);
        }
      });
  return raw_mesh_of(result.bytes);
}

}  // namespace sonard::render
