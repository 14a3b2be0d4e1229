// SPDX-License-Identifier: Apache-2.0
// One sequence of bytes in several pieces, such as the .dat in a .glf.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sonard::glf {

/// Views its pieces and does not own them. After the last append() any thread may read.
class PiecewiseBytes {
 public:
  PiecewiseBytes() = default;
  explicit PiecewiseBytes(std::span<const std::uint8_t> whole) { append(whole); }

  void append(std::span<const std::uint8_t> piece);

  std::uint64_t size() const { return size_; }
  /// Calls visit(std::span<const std::uint8_t>) for each piece in order.
  template <class Visit>
  void for_each_piece(Visit visit) const {
    for (const Piece& piece : pieces_) {
      visit(piece.bytes);
    }
  }
  /// Copies out.size() bytes from `offset` on. Requires offset + out.size() <= size().
  void copy(std::uint64_t offset, std::span<std::uint8_t> out) const;

 private:
  struct Piece {
    std::uint64_t offset;
    std::span<const std::uint8_t> bytes;
  };

  std::vector<Piece> pieces_;  ///< without empty ones
  std::uint64_t size_ = 0;
};

}  // namespace sonard::glf
