// SPDX-License-Identifier: Apache-2.0
// Any bytes as an STL file.
// Promises: an error is a std::runtime_error, and all indices refer to positions.
#include <cstdint>
#include <stdexcept>

#include "renderer/scene/stl_reader.hpp"
#include "tests/fuzz/file_in_memory.hpp"
#include "tests/fuzz/require.hpp"

using namespace sonard::render;
using sonard::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sonard::fuzz::FileInMemory file(".stl");
  file.hold(data, size);
  try {
    const RawMesh mesh = read_stl({file.path()});
    require(mesh.parts.size() <= 1, "an STL has no materials");
    for (const RawPart& part : mesh.parts) {
      require(part.indices.size() % 3 == 0, "there are whole triangles");
      for (const std::uint32_t index : part.indices) {
        require(index < part.positions.size(), "an index is that of a position");
      }
    }
  } catch (const std::runtime_error&) {
  }
  return 0;
}
