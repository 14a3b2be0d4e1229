// SPDX-License-Identifier: Apache-2.0
// The releases of the firmware that the device can have, and what came with each.
#pragma once

#include <array>
#include <string_view>

namespace sonard::dvl_a50 {

enum class Release { v2_1_0, v2_2_1, v2_4_0, v2_6_1, v2_7_1, v2_7_2 };

struct ReleaseTexts {
  std::string_view version;
  std::string_view format;  ///< of JSON messages
  std::string_view serial;  ///< version of the serial protocol
};
inline constexpr std::array<ReleaseTexts, 6> release_texts{{{"2.1.0", "json_v3", "2.3.0"},
                                                            {"2.2.1", "json_v3", "2.4.0"},
                                                            {"2.4.0", "json_v3.1", "2.5.0"},
                                                            {"2.6.1", "json_v3.1", "2.6.0"},
                                                            {"2.7.1", "json_v3.2", "2.7.0"},
                                                            {"2.7.2", "json_v3.3", "2.8.0"}}};
constexpr const ReleaseTexts& texts_of(Release release) {
  return release_texts[static_cast<std::size_t>(release)];
}

}  // namespace sonard::dvl_a50
