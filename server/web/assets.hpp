// SPDX-License-Identifier: Apache-2.0
// The files of the page, which are part of the program.
#pragma once

#include <string_view>

namespace sonard::server {

struct Asset {
  std::string_view path;   ///< "/index.html"
  std::string_view type;   ///< "text/html; charset=utf-8"
  std::string_view bytes;  ///< lives as long as the program
};

/// Null where the page has no such file.
const Asset* find_asset(std::string_view path);

}  // namespace sonard::server
