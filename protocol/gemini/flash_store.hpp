// SPDX-License-Identifier: Apache-2.0
// The flash memory of a head (protocol/gemini/README.md 3.7).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// Flash of 8 MiB [inferred: the last info block lies just below], erased to 0xFF. Only written pages take
/// memory. The content survives reboots of the head, but is never stored on disk.
class FlashStore {
 public:
  static constexpr std::uint32_t size = 0x800000;

  using Page = std::array<std::uint8_t, flash_page_size>;

  /// Replaces the page that contains `address` with `data` and erases the rest of the page. False if the
  /// address is beyond the memory. Requires data.size() <= flash_page_size.
  bool write_page(std::uint32_t address, std::span<const std::uint8_t> data);

  /// Returns 1 KiB from any `address` on; 0xFF in unwritten pages and beyond the memory.
  Page read(std::uint32_t address) const;

 private:
  std::map<std::uint32_t, Page> pages_;  ///< by page number
};

}  // namespace sonard::gemini
