// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/printable.hpp"

#include <cstddef>

#include <fmt/format.h>

namespace sonard::render {

std::string printable(std::string_view text) {
  constexpr unsigned char first_printable = 0x20, del = 0x7F, lead_of_c1 = 0xC2, first_c1 = 0x80,
                          last_c1 = 0x9F;
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : '\0');
    if (byte == lead_of_c1 && next >= first_c1 && next <= last_c1) {
      shown += fmt::format("\\x{:02x}", next);
      ++i;
    } else if (byte < first_printable || byte == del) {
      shown += fmt::format("\\x{:02x}", byte);
    } else {
      shown += text[i];
    }
  }
  return shown;
}

}  // namespace sonard::render
