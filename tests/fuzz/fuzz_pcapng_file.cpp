// SPDX-License-Identifier: Apache-2.0
// Any bytes as a pcapng file.
// Promises: the kept part was in the file, is kept again, and holds as many packets as recover() counts.
#include <cstdint>

#include "protocol/pcapng/blocks.hpp"
#include "tests/fuzz/require.hpp"

using namespace sonard::pcapng;
using sonard::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ByteView file{data, size};
  const auto recovery = recover(file);
  if (!recovery) {
    require(recovery.error().offset <= size, "an error lies inside the file");
    return 0;
  }
  require(recovery->keep_size <= size, "what is kept was there");
  const auto again = recover(file.first(recovery->keep_size));
  require(again && again->keep_size == recovery->keep_size && again->packets == recovery->packets,
          "what was kept is good");
  std::uint64_t packets = 0;
  for (std::size_t offset = 0; offset < recovery->keep_size;) {
    const auto block = block_at(file, offset);
    require(block && *block, "every block that is kept is whole");
    packets += (*block)->type == static_cast<std::uint32_t>(BlockType::enhanced_packet) ? 1 : 0;
    offset = (*block)->end();
  }
  require(packets == recovery->packets, "every packet is counted");
  return 0;
}
