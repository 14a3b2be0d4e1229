// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap/compression.hpp"

#include <cstddef>

#include <zstd.h>

namespace sonard::mcap {

std::vector<std::uint8_t> compress_zstd(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> packed(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1);
  packed.resize(ZSTD_isError(size) != 0 ? 0 : size);
  return packed;
}

std::optional<std::vector<std::uint8_t>> decompress_zstd(std::span<const std::uint8_t> bytes,
                                                         std::uint64_t size) {
  if (size > largest_unpacked_chunk) {
    return std::nullopt;
  }
  // Check the size that the frame states first, so that a broken frame cannot cause an allocation.
  const unsigned long long said = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (said == ZSTD_CONTENTSIZE_ERROR || (said != ZSTD_CONTENTSIZE_UNKNOWN && said != size)) {
    return std::nullopt;
  }
  std::vector<std::uint8_t> unpacked(static_cast<std::size_t>(size));
  const std::size_t got = ZSTD_decompress(unpacked.data(), unpacked.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(got) != 0 || got != unpacked.size()) {
    return std::nullopt;
  }
  return unpacked;
}

}  // namespace sonard::mcap
