// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/http.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

namespace sonard::sonar3d15 {
namespace {

constexpr std::string_view line_end = "\r\n";
constexpr std::string_view head_end = "\r\n\r\n";

std::string_view reason_of(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 400:
      return "Bad Request";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 409:
      return "Conflict";
    case 411:
      return "Length Required";
    case 413:
      return "Content Too Large";
    case 431:
      return "Request Header Fields Too Large";
    default:
      return "Not Implemented";
  }
}

bool same(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return std::ranges::equal(a, b, {}, lower, lower);
}

/// Cuts the text before `end` off `rest`; all of it if there is no `end`.
std::string_view take_until(std::string_view& rest, std::string_view end) {
  const std::size_t found = std::min(rest.find(end), rest.size());
  const std::string_view taken = rest.substr(0, found);
  rest.remove_prefix(std::min(rest.size(), found + end.size()));
  return taken;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

/// The value of a header field; nullopt if it is missing.
std::optional<std::string_view> field(std::string_view head, std::string_view name) {
  while (!head.empty()) {
    std::string_view value = take_until(head, line_end);
    if (same(take_until(value, ":"), name)) {
      return trimmed(value);
    }
  }
  return std::nullopt;
}

std::optional<std::size_t> number(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc::invalid_argument || end != text.data() + text.size()
             ? std::nullopt
             : std::optional(error == std::errc{} ? value : most_body_size + 1);
}

/// The path of a request's target, which proxies may precede by scheme and host.
std::string_view path_of(std::string_view target) {
  if (!target.starts_with('/')) {
    const std::size_t host = target.find("://");
    target = target.substr(
        std::min(host == std::string_view::npos ? host : target.find('/', host + 3), target.size()));
  }
  return target.substr(0, target.find('?'));
}

std::vector<std::uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

}  // namespace

std::vector<std::uint8_t> encode(const Reply& reply, bool stays) {
  std::string text = fmt::format("HTTP/1.1 {} {}\r\n", reply.status, reason_of(reply.status));
  if (reply.status != 204) {
    text += fmt::format("Content-Type: {}\r\nContent-Length: {}\r\n", reply.content_type, reply.body.size());
  }
  return bytes_of(text + (stays ? "\r\n" : "Connection: close\r\n\r\n") + reply.body);
}

std::vector<std::uint8_t> encode(const Request& request) {
  return bytes_of(fmt::format("{} {} HTTP/1.1\r\nHost: sonar\r\nContent-Length: {}\r\n{}\r\n{}",
                              request.method, request.path, request.body.size(),
                              request.stays ? "" : "Connection: close\r\n", request.body));
}

std::optional<Reply> decode_reply(std::span<const std::uint8_t> bytes) {
  const std::string text(bytes.begin(), bytes.end());
  std::string_view body = text;
  std::string_view head = take_until(body, head_end);
  std::string_view line = take_until(head, line_end);
  if (take_until(line, " ") != "HTTP/1.1") {
    return std::nullopt;
  }
  const auto status = number(take_until(line, " "));
  const auto size = number(field(head, "Content-Length").value_or("0"));
  if (!status || !size || *size != body.size()) {
    return std::nullopt;
  }
  return Reply{static_cast<int>(*status), std::string(body), ""};
}

void RequestBuffer::append(std::span<const std::uint8_t> bytes) {
  if (!broken_) {
    text_.append(bytes.begin(), bytes.end());
  }
}

Result<Request, int> RequestBuffer::broken(int status) {
  broken_ = true;
  text_ = {};
  return status;
}

std::optional<Result<Request, int>> RequestBuffer::next() {
  const std::size_t head_size = text_.find(head_end);
  if (std::min(head_size, text_.size()) > most_head_size) {
    return broken(431);
  }
  if (head_size == std::string::npos) {
    return std::nullopt;
  }
  std::string_view head = std::string_view(text_).substr(0, head_size);
  std::string_view line = take_until(head, line_end);
  Request request;
  request.method = take_until(line, " ");
  request.path = path_of(take_until(line, " "));
  const auto length = field(head, "Content-Length");
  const auto size = number(length.value_or("0"));
  if (!line.starts_with("HTTP/1.") || !size || request.path.empty()) {
    return broken(400);
  }
  if (field(head, "Transfer-Encoding")) {
    return broken(501);
  }
  if (!length && request.method == "POST") {
    return broken(411);
  }
  if (*size > most_body_size) {
    return broken(413);
  }
  const std::size_t whole = head_size + head_end.size() + *size;
  if (text_.size() < whole) {
    return std::nullopt;
  }
  request.stays = line != "HTTP/1.0" && !same(field(head, "Connection").value_or(""), "close");
  request.body = text_.substr(whole - *size, *size);
  text_.erase(0, whole);
  return request;
}

}  // namespace sonard::sonar3d15
