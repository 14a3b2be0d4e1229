// SPDX-License-Identifier: Apache-2.0
// Any bytes as a world in SDF. Models and meshes that it names do not exist.
// Promises: a world with finite triangles, or an error with a text; nothing else is thrown.
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "renderer/scene/world.hpp"
#include "tests/fuzz/file_in_memory.hpp"
#include "tests/fuzz/require.hpp"

using sonard::fuzz::require;
using namespace sonard::render;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sonard::fuzz::FileInMemory file(".sdf");
  file.hold(data, size);
  try {
    const World world = load_world(file.path(), {}, MissingFiles::skip);
    for (const Body& body : world.bodies) {
      require(!body.name.empty(), "a body has a name");
      for (const auto& part : body.parts) {
        for (const auto& position : part.mesh->positions) {
          require(std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z),
                  "corners are finite");
        }
        for (const auto index : part.mesh->indices) {
          require(index < part.mesh->positions.size(), "triangles have corners that are there");
        }
      }
    }
  } catch (const WorldError& error) {
    require(error.what()[0] != '\0', "an error has words");
  }
  return 0;
}
