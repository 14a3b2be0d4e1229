// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/mesh_readers.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

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

constexpr MeshReader assimp{"Assimp", read_with_assimp};
constexpr MeshReader osg{"OpenSceneGraph",
                         [](const MeshSource& source) { return read_with_osg(source.file, source.submesh); },
                         load_osg_plugin};
constexpr MeshReader ply{"PLY",
                         [](const MeshSource& source) { return read_ply(source.file, source.submesh); }};
constexpr MeshReader stl{"STL",
                         [](const MeshSource& source) { return read_stl(source.file, source.submesh); }};

struct Format {
  std::string_view extension;
  const MeshReader* first;
  const MeshReader* second = nullptr;
};

/// Only Assimp for OBJ: OpenSceneGraph reads no OBJ that Assimp cannot, and opens any file that mtllib names.
constexpr std::array<Format, 11> formats{{{"obj", &assimp},
                                          {"stl", &stl},
                                          {"ply", &ply},
                                          {"dae", &assimp, &osg},
                                          {"glb", &assimp},
                                          {"gltf", &assimp},
                                          {"fbx", &assimp},
                                          {"osgt", &osg},
                                          {"osgb", &osg},
                                          {"ive", &osg},
                                          {"3ds", &assimp, &osg}}};

RawMesh read_isolated(const MeshReader& reader, const MeshSource& source) {
  std::vector<std::filesystem::path> readable = source.folders;
  readable.push_back(source.file.parent_path());
  const IsolatedResult result = run_isolated(
      [&] {
        require_complete(source.file);
        return to_bytes(reader.read(source));
      },
      reader_jail(source.file, std::move(readable)),
      [&] {
        if (reader.prepare != nullptr) {
          reader.prepare(source.file);
        }
      });
  return raw_mesh_of(result.bytes);
}

/// Whether any triangle has an area. A reader that misinterprets the file may return identical corners.
bool has_surface(const RawPart& part) {
  for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return part.positions[part.indices[i + k]]; };
    const auto is_there = [&](std::size_t k) { return part.indices[i + k] < part.positions.size(); };
    if (is_there(0) && is_there(1) && is_there(2) &&
        glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0))) > 0.0) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::span<const std::string_view> mesh_extensions() {
  static const std::vector<std::string_view> extensions = [] {
    std::vector<std::string_view> all;
    std::ranges::transform(formats, std::back_inserter(all), &Format::extension);
    return all;
  }();
  return extensions;
}

std::vector<MeshReader> mesh_readers(const std::filesystem::path& file) {
  std::vector<MeshReader> readers;
  for (const Format& format : formats) {
    if (format.extension == lower_extension(file)) {
      readers.push_back(*format.first);
      if (format.second != nullptr) {
        readers.push_back(*format.second);
      }
    }
  }
  return readers;
}

RawMesh read_mesh(std::span<const MeshReader> readers, const MeshSource& source,
                  std::vector<std::string>& warnings) {
  std::vector<std::string> failures;
  std::optional<RawMesh> without_triangles;
  for (const MeshReader& reader : readers) {
    try {
      RawMesh mesh = read_isolated(reader, source);
      if (std::ranges::any_of(mesh.parts, has_surface)) {
        if (!failures.empty()) {
          warnings.push_back(
              fmt::format("{}: read by {}, because {}; check its shape, or export the mesh again",
                          source.file.string(), reader.name, fmt::join(failures, "; ")));
        }
        for (const std::string& warning : mesh.warnings) {
          warnings.push_back(fmt::format("{}: {}", source.file.string(), warning));
        }
        return mesh;
      }
      without_triangles = without_triangles ? std::move(without_triangles) : std::move(mesh);
    } catch (const IsolatedFailure& error) {
      failures.push_back(readers.size() == 1 ? error.what()
                                             : fmt::format("{} reports: {}", reader.name, error.what()));
    }
  }
  if (!without_triangles) {
    throw std::runtime_error(fmt::format(
        "{}{}", readers.size() == 1 ? "" : "no reader can read this file: ", fmt::join(failures, "; ")));
  }
  return std::move(*without_triangles);
}

}  // namespace sonard::render
