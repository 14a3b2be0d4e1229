// SPDX-License-Identifier: Apache-2.0
// Reads fields out of bytes whose length and content are not trusted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "protocol/common/wire_error.hpp"

namespace sonard {

/// Reads `bytes` from front to back. The first read past the end latches an error with the field's name and
/// offset. Later reads return zero or an empty span, so decoders check error() only once, at their end.
/// Views `bytes`; does not own them.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint8_t u8(std::string_view field) { return static_cast<std::uint8_t>(little_endian(1, field)); }
  std::uint16_t u16le(std::string_view field) { return static_cast<std::uint16_t>(little_endian(2, field)); }
  std::uint32_t u32le(std::string_view field) { return static_cast<std::uint32_t>(little_endian(4, field)); }
  std::uint64_t u64le(std::string_view field) { return little_endian(8, field); }

  /// Unsigned little-endian integer of 1..8 bytes.
  std::uint64_t little_endian(std::size_t width, std::string_view field) {
    std::uint64_t value = 0;
    const auto raw = bytes(width, field);
    for (std::size_t i = raw.size(); i-- > 0;) {
      value = value << 8 | raw[i];
    }
    return value;
  }

  /// The next `count` bytes as a view; empty after an error.
  std::span<const std::uint8_t> bytes(std::size_t count, std::string_view field) {
    if (error_ || count > remaining()) {
      fail(WireErrorReason::truncated, field);
      return {};
    }
    const auto view = bytes_.subspan(offset_, count);
    offset_ += count;
    return view;
  }

  void skip(std::size_t count, std::string_view field) { static_cast<void>(bytes(count, field)); }

  /// Latches an error at the current offset, unless an error is latched already.
  void fail(WireErrorReason reason, std::string_view field) { fail_at(offset_, reason, field); }
  /// Latches an error at another offset, for example at a count that was read earlier.
  void fail_at(std::size_t offset, WireErrorReason reason, std::string_view field) {
    if (!error_) {
      error_ = WireError{reason, offset, field};
    }
  }

  std::size_t offset() const { return offset_; }
  std::size_t remaining() const { return bytes_.size() - offset_; }
  bool ok() const { return !error_; }
  const std::optional<WireError>& error() const { return error_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t offset_ = 0;
  std::optional<WireError> error_;
};

}  // namespace sonard
