// SPDX-License-Identifier: Apache-2.0
// Appends fields to a byte vector, the mirror of ByteReader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sonard {

/// Appends to `out`, which must outlive the writer. Cannot fail.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::uint8_t>& out) : out_(out), start_(out.size()) {}

  void u8(std::uint8_t value) { out_.push_back(value); }
  void u16le(std::uint16_t value) { little_endian(value, 2); }
  void u32le(std::uint32_t value) { little_endian(value, 4); }
  void u64le(std::uint64_t value) { little_endian(value, 8); }

  /// Appends the low `width` bytes of `value`, least significant first; width 1..8.
  void little_endian(std::uint64_t value, std::size_t width) {
    for (std::size_t i = 0; i < width; ++i) {
      out_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }

  void bytes(std::span<const std::uint8_t> data) { out_.insert(out_.end(), data.begin(), data.end()); }
  void zeros(std::size_t count) { out_.resize(out_.size() + count); }

  /// Bytes written so far.
  std::size_t offset() const { return out_.size() - start_; }

 private:
  std::vector<std::uint8_t>& out_;
  std::size_t start_;
};

}  // namespace sonard
