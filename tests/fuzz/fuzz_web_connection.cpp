// SPDX-License-Identifier: Apache-2.0
// Any bytes from a browser that connects to the page and leaves: requests, and data after a WebSocket's
// handshake. Promises: nothing is thrown, and the connection is over when its client has left.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "tests/fuzz/page_client.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static sonard::fuzz::Page page;
  sonard::fuzz::PageClient client(page);
  client.send({reinterpret_cast<const char*>(data), size});
  sonard::fuzz::require(client.leave(), "the connection is over when its client has left");
  return 0;
}
