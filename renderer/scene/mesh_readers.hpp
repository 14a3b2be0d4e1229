// SPDX-License-Identifier: Apache-2.0
// The readers of each mesh format, in their order. The order is measured: docs/worlds.md.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/raw_mesh.hpp"

namespace sonard::render {

struct MeshReader {
  std::string_view name;
  RawMesh (*read)(const MeshSource& source);
  void (*prepare)(const std::filesystem::path& file) = nullptr;  ///< runs before the process is confined
};

/// Extensions of the supported formats, in lower case without the dot.
std::span<const std::string_view> mesh_extensions();

/// The readers for the file's format, the best one first; at least one if the extension is known.
std::vector<MeshReader> mesh_readers(const std::filesystem::path& file);

/// Returns the triangles of the first reader that finds one with an area, in the unit and the axes of the
/// file (an FBX: in metres, z up). Each reader runs in a separate process.
/// If no reader finds one, this returns the result of the first that can read the file. If a reader fails and
/// a later one reads the file, that adds a warning.
/// @throws std::runtime_error with the message of each reader, if none can read the file.
RawMesh read_mesh(std::span<const MeshReader> readers, const MeshSource& source,
                  std::vector<std::string>& warnings);

}  // namespace sonard::render
