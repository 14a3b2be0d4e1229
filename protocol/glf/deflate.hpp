// SPDX-License-Identifier: Apache-2.0
// What logs need of zlib. No state but Crc32's; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sonard::glf {

using Bytes = std::vector<std::uint8_t>;

/// CRC-32 of ZIP and zlib, over pieces in order.
class Crc32 {
 public:
  void add(std::span<const std::uint8_t> bytes);
  std::uint32_t value() const { return value_; }

 private:
  std::uint32_t value_ = 0;
};

/// A zlib stream, or nullopt where that would not be shorter.
/// @param bytes what is packed
/// @param level 0 (nothing gets shorter) .. 9; 1 is the fastest that packs
/// @throws std::invalid_argument for another level
std::optional<Bytes> deflate_shorter(std::span<const std::uint8_t> bytes, int level);

enum class DeflateForm : std::uint8_t { zlib, bare };  ///< with zlib's header and checksum, or as ZIP has it

/// Unpacks a stream of exactly `size` bytes; nullopt for anything else. Bytes after its end do not matter.
/// A `size` that no stream of that many bytes unpacks to is refused before anything is allocated.
std::optional<Bytes> inflate_exactly(std::span<const std::uint8_t> stream, std::uint64_t size,
                                     DeflateForm form);

/// Unpacks a bare stream as far as it can be read, `max_size` bytes at most.
Bytes inflate_front(std::span<const std::uint8_t> stream, std::uint64_t max_size);

}  // namespace sonard::glf
