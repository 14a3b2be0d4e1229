// SPDX-License-Identifier: Apache-2.0
// HTTP/1.1 as far as clients of a Sonar 3D-15 use it: requests with a Content-Length, on streams that may
// stay open. Source: protocol/sonar3d15/README.md 5. No sockets: bytes <-> values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/result.hpp"

namespace sonard::sonar3d15 {

inline constexpr std::size_t most_head_size = 8192;   ///< of a request, until its empty line
inline constexpr std::size_t most_body_size = 65536;  ///< of a request

struct Request {
  std::string method;  ///< "GET"
  std::string path;    ///< "/api/v1/about", without a query
  std::string body;
  bool stays = true;  ///< the client keeps the connection open
};

struct Reply {
  int status = 200;
  std::string body;
  std::string_view content_type = "application/json; charset=utf-8";  ///< a literal
};

/// A whole reply. If not `stays`, the head closes the connection after it.
std::vector<std::uint8_t> encode(const Reply& reply, bool stays);
/// A whole request, as a client sends it.
std::vector<std::uint8_t> encode(const Request& request);
/// Decodes a whole reply without its content type; nullopt if it is not whole.
std::optional<Reply> decode_reply(std::span<const std::uint8_t> bytes);

/// Collects the bytes of one client, in parts of any size, into requests. Not thread-safe.
class RequestBuffer {
 public:
  void append(std::span<const std::uint8_t> bytes);
  /// Removes the request in front; nullopt if none is whole. The error is the status of the last reply: the
  /// buffer drops all bytes after it, so close the connection. 400: not HTTP, 411: no Content-Length, 413:
  /// the body is too long, 431: the head is too long, 501: a transfer coding.
  std::optional<Result<Request, int>> next();

 private:
  Result<Request, int> broken(int status);

  std::string text_;
  bool broken_ = false;
};

}  // namespace sonard::sonar3d15
