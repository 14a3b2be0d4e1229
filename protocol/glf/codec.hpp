// SPDX-License-Identifier: Apache-2.0
// Records of a log <-> values. Source: docs/logs.md 1.3 to 1.5. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::glf {

inline constexpr int default_zlib_level = 1;  ///< recording is to cost little

/// Most pixels of an image that is read: 1024 beams by 16384 lines.
inline constexpr std::uint64_t max_pixels = std::uint64_t{1} << 24;

/// One record with its header. Pixels are packed by zlib at `zlib_level`, 0..9, and stored as they are where
/// that makes them no shorter.
/// @throws std::invalid_argument where pixels are not lines * beams, bearings not beams, or the level is none
std::vector<std::uint8_t> encode(const ImageRecord& image, int zlib_level = default_zlib_level);
std::vector<std::uint8_t> encode(const StatusRecord& status);

/// The record that `record` starts with; bytes after it do not matter, nor does the length in its header,
/// which other programs write wrong. Offsets of errors count from the header. An image is refused when its
/// pixels do not unpack to lines * beams bytes, when they are H.264, or when it has an acoustic zoom.
Result<ImageRecord, WireError> decode_image(std::span<const std::uint8_t> record);
Result<StatusRecord, WireError> decode_status(std::span<const std::uint8_t> record);

}  // namespace sonard::glf
