// SPDX-License-Identifier: Apache-2.0
// Any bytes as a PLY file.
// Promises: an error is a std::runtime_error, and there are whole triangles in at most one part.
#include <cstdint>
#include <stdexcept>

#include "renderer/scene/ply_reader.hpp"
#include "tests/fuzz/file_in_memory.hpp"
#include "tests/fuzz/require.hpp"

using namespace sonard::render;
using sonard::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sonard::fuzz::FileInMemory file(".ply");
  file.hold(data, size);
  try {
    const RawMesh mesh = read_ply({file.path()});
    require(mesh.parts.size() <= 1, "a PLY has no materials");
    for (const RawPart& part : mesh.parts) {
      require(part.indices.size() % 3 == 0, "there are whole triangles");
    }
  } catch (const std::runtime_error&) {
  }
  return 0;
}
