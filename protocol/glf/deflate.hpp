// SPDX-License-Identifier: Apache-2.0
// The zlib functions that logs need. No state except in Crc32; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sonard::glf {

using Bytes = std::vector<std::uint8_t>;

/// CRC-32 of ZIP and zlib, over consecutive parts.
class Crc32 {
 public:
  void add(std::span<const std::uint8_t> bytes);
  std::uint32_t value() const { return value_; }

 private:
  std::uint32_t value_ = 0;
};

/// Compresses to a zlib stream; nullopt if it would not be shorter.
/// @param bytes input
/// @param level 0 (no compression) to 9; 1 is the fastest compression
/// @throws std::invalid_argument for another level
std::optional<Bytes> deflate_shorter(std::span<const std::uint8_t> bytes, int level);

enum class DeflateForm : std::uint8_t { zlib, bare };  ///< with zlib's header and checksum, or as in ZIP

/// Unpacks a stream to exactly `size` bytes; nullopt if it has another size or is invalid. Ignores bytes
/// after its end. Rejects an impossible `size` before allocating memory.
std::optional<Bytes> inflate_exactly(std::span<const std::uint8_t> stream, std::uint64_t size,
                                     DeflateForm form);

/// Unpacks a bare stream as far as possible, at most `max_size` bytes.
Bytes inflate_front(std::span<const std::uint8_t> stream, std::uint64_t max_size);

}  // namespace sonard::glf
