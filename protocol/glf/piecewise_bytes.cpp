// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/piecewise_bytes.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace sonard::glf {

void PiecewiseBytes::append(std::span<const std::uint8_t> piece) {
  if (!piece.empty()) {
    pieces_.push_back({size_, piece});
    size_ += piece.size();
  }
}

void PiecewiseBytes::copy(std::uint64_t offset, std::span<std::uint8_t> out) const {
  assert(offset <= size_ && out.size() <= size_ - offset);
  if (out.empty()) {
    return;
  }
  auto piece = std::prev(std::ranges::upper_bound(pieces_, offset, {}, &Piece::offset));
  for (std::size_t done = 0; done < out.size(); ++piece) {
    const auto rest = piece->bytes.subspan(offset + done - piece->offset);
    const auto taken = rest.first(std::min(rest.size(), out.size() - done));
    std::ranges::copy(taken, out.begin() + static_cast<std::ptrdiff_t>(done));
    done += taken.size();
  }
}

}  // namespace sonard::glf
