// SPDX-License-Identifier: Apache-2.0
// Which readers take which mesh format, in what order. The order is by measurement: docs/worlds.md.
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
  void (*prepare)(const std::filesystem::path& file) = nullptr;  ///< before the process is confined
};

/// Extensions of the formats that can be read, in lower case without the dot.
std::span<const std::string_view> mesh_extensions();

/// The readers of the file's format, the best one first; at least one if its extension is known.
std::vector<MeshReader> mesh_readers(const std::filesystem::path& file);

/// The triangles of the first of `readers` that finds one with an area, in the unit and the axes of the file
/// (an FBX: in metres, z up). Each reader runs in a separate process.
/// If no reader finds one, this returns the result of the first that can read the file. If a reader fails and
/// a later one reads the file, that is a warning.
/// @throws std::runtime_error with what each reader said, if none can read the file.
RawMesh read_mesh(std::span<const MeshReader> readers, const MeshSource& source,
                  std::vector<std::string>& warnings);

}  // namespace sonard::render
