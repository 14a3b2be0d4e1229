// SPDX-License-Identifier: Apache-2.0
// Zstandard compression for chunks of MCAP files.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace sonard::mcap {

/// The name in a chunk; an empty name means no compression.
inline constexpr std::string_view zstd_name = "zstd";
/// Limit for chunks that are read. Writers make chunks of a few megabytes.
inline constexpr std::uint64_t largest_unpacked_chunk = std::uint64_t{256} << 20;

/// Compresses at level 1, which is fast; empty on an error.
std::vector<std::uint8_t> compress_zstd(std::span<const std::uint8_t> bytes);
/// Decompresses; nullopt if `bytes` do not unpack to `size` bytes, or if `size` exceeds
/// largest_unpacked_chunk.
std::optional<std::vector<std::uint8_t>> decompress_zstd(std::span<const std::uint8_t> bytes,
                                                         std::uint64_t size);

}  // namespace sonard::mcap
