// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/flash_store.hpp"

#include <algorithm>

namespace sonard::gemini {

namespace {

constexpr std::uint8_t erased = 0xFF;

}  // namespace

bool FlashStore::write_page(std::uint32_t address, std::span<const std::uint8_t> data) {
  if (address >= size) {
    return false;
  }
  Page& page = pages_[address / flash_page_size];
  page.fill(erased);
  std::ranges::copy(data, page.begin());
  return true;
}

FlashStore::Page FlashStore::read(std::uint32_t address) const {
  Page result;
  result.fill(erased);
  const std::size_t offset = address % flash_page_size;
  if (const auto first = pages_.find(address / flash_page_size); first != pages_.end()) {
    std::copy(first->second.begin() + static_cast<std::ptrdiff_t>(offset), first->second.end(),
              result.begin());
  }
  if (const auto second = pages_.find(address / flash_page_size + 1); second != pages_.end()) {
    std::copy_n(second->second.begin(), offset, result.end() - static_cast<std::ptrdiff_t>(offset));
  }
  return result;
}

}  // namespace sonard::gemini
