// SPDX-License-Identifier: Apache-2.0
// JSON messages of a viewer. Each line of the input is one text message on a WebSocket of the page, bytes
// that are not ASCII replaced; the first byte chooses the protocol. Promises: the page answers each message
// that is not JSON, all that it sends is JSON, and the connection stays open until its client leaves.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "tests/fuzz/page_client.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using sonard::fuzz::require;

constexpr std::string_view live =
    "GET /api/live HTTP/1.1\r\nHost: 127.0.0.1:8014\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n";
constexpr std::string_view foxglove =
    "GET / HTTP/1.1\r\nHost: 127.0.0.1:8014\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n";

constexpr unsigned char final_text = 0x81, final_close = 0x88, masked = 0x80;  // RFC 6455, 5.2

/// A frame of a client, whose mask changes nothing.
std::string text_frame(std::string_view text) {
  std::string frame;
  frame += static_cast<char>(final_text);
  if (text.size() < 126) {
    frame += static_cast<char>(masked | text.size());
  } else {
    frame += static_cast<char>(masked | 126);
    frame += static_cast<char>(text.size() >> 8);
    frame += static_cast<char>(text.size() & 0xFF);
  }
  return frame.append(4, '\0').append(text);
}

std::size_t big_endian(std::string_view bytes) {
  std::size_t value = 0;
  for (const char byte : bytes) {
    value = value << 8 | static_cast<unsigned char>(byte);
  }
  return value;
}

/// Looks at each whole frame of the server. @return number of text messages
int check_frames(std::string_view bytes) {
  int messages = 0;
  while (bytes.size() >= 2) {
    const auto kind = static_cast<unsigned char>(bytes[0]);
    const std::size_t short_length = static_cast<unsigned char>(bytes[1]);
    const std::size_t more = short_length == 127 ? 8 : short_length == 126 ? 2 : 0;
    if (bytes.size() < 2 + more) {
      break;
    }
    const std::size_t length = more == 0 ? short_length : big_endian(bytes.substr(2, more));
    if (bytes.size() < 2 + more + length) {
      break;
    }
    require(kind != final_close, "the page does not close the connection");
    if (kind == final_text) {
      ++messages;
      const std::string_view text = bytes.substr(2 + more, length);
      require(nlohmann::json::accept(text), "each text message of the page is JSON");
    }
    bytes.remove_prefix(2 + more + length);
  }
  return messages;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static sonard::fuzz::Page page;
  std::string_view input(reinterpret_cast<const char*>(data), size);
  if (input.empty()) {
    return 0;
  }
  const bool is_live = input[0] == 'l';
  input.remove_prefix(1);
  sonard::fuzz::PageClient client(page);
  client.send(is_live ? live : foxglove);
  const std::size_t head = client.received().find("\r\n\r\n");
  require(client.received().starts_with("HTTP/1.1 101 ") && head != std::string::npos,
          "the handshake succeeds");
  int unreadable = 0;
  while (!input.empty()) {
    std::string line(input.substr(0, input.find('\n')));
    input.remove_prefix(std::min(input.size(), line.size() + 1));
    std::ranges::replace_if(
        line, [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
    line.resize(std::min<std::size_t>(line.size(), 4096));  // more is refused
    client.send(text_frame(line));
    unreadable += nlohmann::json::accept(line) ? 0 : 1;
  }
  const int messages = check_frames(std::string_view(client.received()).substr(head + 4));
  require(messages >= unreadable, "each message that is not JSON is answered");
  require(client.leave(), "the connection is over when its client has left");
  return 0;
}
