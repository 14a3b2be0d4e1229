// SPDX-License-Identifier: Apache-2.0
// Any bytes from a browser that connects to the page and leaves: requests, and what follows a WebSocket's
// handshake. Promises: nothing is thrown, and the connection is over when its client has left.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"
#include "server/web/http_session.hpp"
#include "server/web/site.hpp"
#include "server/web/status.hpp"
#include "tests/fuzz/require.hpp"

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using sonard::fuzz::require;
using namespace sonard::server;

sonard::render::World wall() {
  auto mesh = std::make_shared<sonard::render::TriangleMesh>();
  mesh->positions = {{1, 1, -1}, {1, 1, 1}, {1, -1, 1}, {1, -1, -1}};
  mesh->indices = {0, 1, 2, 0, 2, 3};
  sonard::render::World world;
  sonard::render::Body& body = world.bodies.emplace_back();
  body.name = "wall";
  body.parts.push_back({mesh, {}, {}, nullptr});
  return world;
}

DaemonStatus status() {
  DaemonStatus status;
  HeadStatus& head = status.heads.emplace_back();
  head.name = "bow";
  head.kind = "gemini_720i";
  return status;
}

/// A page whose thread is this one.
struct Page {
  sonard::render::World world = wall();
  asio::io_context io{1};
  Site site{WebConfig{},
            WebSources{.ask_status = [](const std::function<void(DaemonStatus)>& take) { take(status()); },
                       .turn_recording = [](bool) {},
                       .identity = {"sonard.yaml", "wall", 0.0},
                       .world = world},
            [](const std::function<Text()>& make, const std::function<void(Text)>& take) { take(make()); }};
  tcp::acceptor acceptor{io, tcp::endpoint(asio::ip::address_v4::loopback(), 0)};
};

/// All that happens while the client reads what comes; @return bytes read
void run(asio::io_context& io, tcp::socket& client) {
  std::array<char, 65536> bytes{};
  boost::system::error_code error;
  for (bool more = true; more;) {
    io.restart();
    more = io.poll() > 0;
    more = client.read_some(asio::buffer(bytes), error) > 0 || more;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Page page;
  spdlog::set_level(spdlog::level::off);
  tcp::socket client(page.io);
  client.connect(page.acceptor.local_endpoint());
  tcp::socket served = page.acceptor.accept();
  std::weak_ptr<HttpSession> session;
  {
    const auto started =
        std::make_shared<HttpSession>(page.site, std::move(served), sonard::Endpoint{0x7F000001, 1});
    started->start();
    session = started;
  }
  client.non_blocking(true);
  boost::system::error_code error;
  for (std::size_t sent = 0; sent < size && !error;) {
    sent += client.write_some(asio::buffer(data + sent, size - sent), error);
    run(page.io, client);
  }
  client.shutdown(tcp::socket::shutdown_send, error);
  run(page.io, client);
  client.close(error);
  run(page.io, client);
  require(session.expired(), "the connection is over when its client has left");
  return 0;
}
