// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/http.hpp"

#include <fmt/format.h>

namespace sonard::dvl_a50 {

std::optional<std::string> requested_path(std::string_view request) {
  if (request.find("\r\n\r\n") == std::string_view::npos && request.find("\n\n") == std::string_view::npos) {
    return std::nullopt;
  }
  if (!request.starts_with("GET ")) {
    return "";
  }
  request.remove_prefix(4);
  return std::string(request.substr(0, request.find_first_of(" ?\r\n")));
}

std::string http_response(std::string_view status, std::string_view content_type, std::string_view body) {
  return fmt::format(
      "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n"
      "Connection: close\r\n\r\n{}",
      status, content_type, body.size(), body);
}

}  // namespace sonard::dvl_a50
