// SPDX-License-Identifier: Apache-2.0
// The files of the page, compiled into the program.
#pragma once

#include <string_view>

namespace sonard::server {

struct Asset {
  std::string_view path;   ///< "/index.html"
  std::string_view type;   ///< "text/html; charset=utf-8"
  std::string_view bytes;  ///< valid for the life of the program
};

/// Null if the page has no such file.
const Asset* find_asset(std::string_view path);

}  // namespace sonard::server
