// SPDX-License-Identifier: Apache-2.0
// The flash memory of a head (docs/protocols/gemini.md 3.7).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// 8 MiB [inferred: the last info block lies just below], erased to 0xFF. Only pages that were written take
/// memory. Lives as long as the head object, across reboots of the head; nothing is kept on disk.
class FlashStore {
 public:
  static constexpr std::uint32_t size = 0x800000;

  using Page = std::array<std::uint8_t, flash_page_size>;

  /// Replaces the page that contains `address` with `data`, the rest of the page is erased. False when the
  /// address is beyond the memory. Requires data.size() <= flash_page_size.
  bool write_page(std::uint32_t address, std::span<const std::uint8_t> data);

  /// 1 KiB from `address` on, which may begin anywhere; 0xFF where nothing was written or memory ends.
  Page read(std::uint32_t address) const;

 private:
  std::map<std::uint32_t, Page> pages_;  ///< by page number
};

}  // namespace sonard::gemini
