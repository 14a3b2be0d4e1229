// SPDX-License-Identifier: Apache-2.0
// Records of a log <-> values. Source: protocol/glf/README.md 1.3 to 1.5. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::glf {

inline constexpr int default_zlib_level = 1;  ///< the fastest, so that recording takes little time

/// Maximum number of pixels of an image: 1024 beams by 16384 lines.
inline constexpr std::uint64_t max_pixels = std::uint64_t{1} << 24;

/// Encodes one record with its header. Compresses pixels with zlib at `zlib_level`, 0..9, or stores them raw
/// if compression does not make them shorter.
/// @throws std::invalid_argument if the numbers of pixels or bearings do not match lines and beams, if there
/// are more than max_pixels, or if the level is out of range
std::vector<std::uint8_t> encode(const ImageRecord& image, int zlib_level = default_zlib_level);
std::vector<std::uint8_t> encode(const StatusRecord& status);

/// Decodes the record at the front of `record`. Ignores bytes after it and the length in its header, which
/// other programs write incorrectly. Offsets of errors count from the header. Rejects an image if its pixels
/// do not unpack to lines * beams bytes, if they are H.264, or if it has an acoustic zoom.
Result<ImageRecord, WireError> decode_image(std::span<const std::uint8_t> record);
Result<StatusRecord, WireError> decode_status(std::span<const std::uint8_t> record);

}  // namespace sonard::glf
