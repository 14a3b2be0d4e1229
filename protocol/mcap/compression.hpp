// SPDX-License-Identifier: Apache-2.0
// Chunks of MCAP files that are compressed with Zstandard.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace sonard::mcap {

/// As a chunk spells it; an empty text: it is not compressed.
inline constexpr std::string_view zstd_name = "zstd";
/// No chunk that is read may hold more: writers make them of a few megabytes.
inline constexpr std::uint64_t largest_unpacked_chunk = std::uint64_t{256} << 20;

/// Quickly rather than much: level 1.
std::vector<std::uint8_t> compress_zstd(std::span<const std::uint8_t> bytes);
/// nullopt where `bytes` are not one whole frame of `size` bytes.
std::optional<std::vector<std::uint8_t>> decompress_zstd(std::span<const std::uint8_t> bytes,
                                                         std::uint64_t size);

}  // namespace sonard::mcap
