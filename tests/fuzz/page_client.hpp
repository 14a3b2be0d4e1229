// SPDX-License-Identifier: Apache-2.0
// The page of a daemon with one head and one wall, and a client that connects to it, all on one thread.
#pragma once

#include <array>
#include <csignal>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <spdlog/spdlog.h>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "renderer/scene/world.hpp"
#include "server/web/http_session.hpp"
#include "server/web/site.hpp"
#include "server/web/status.hpp"
#include "server/web/web_config.hpp"

namespace sonard::fuzz {

inline render::World wall() {
  auto mesh = std::make_shared<render::TriangleMesh>();
  mesh->positions = {{1, 1, -1}, {1, 1, 1}, {1, -1, 1}, {1, -1, -1}};
  mesh->indices = {0, 1, 2, 0, 2, 3};
  render::World world;
  render::Body& body = world.bodies.emplace_back();
  body.name = "wall";
  body.parts.push_back({mesh, {}, {}, nullptr});
  return world;
}

inline server::DaemonStatus status_of_one_head() {
  server::DaemonStatus status;
  server::HeadStatus& head = status.heads.emplace_back();
  head.name = "bow";
  head.type = "gemini_720i";
  return status;
}

/// A page whose thread is the caller's.
struct Page {
  render::World world = wall();
  boost::asio::io_context io{1};
  server::Site site{server::WebConfig{},
                    server::WebSources{.ask_status =
                                           [](const std::function<void(server::DaemonStatus)>& take) {
                                             take(status_of_one_head());
                                           },
                                       .turn_recording = [](bool) {},
                                       .identity = {"sonard.yaml", "wall", 0.0},
                                       .world = world},
                    [](const std::function<server::Text()>& make,
                       const std::function<void(server::Text)>& take) { take(make()); }};
  boost::asio::ip::tcp::acceptor acceptor{
      io, boost::asio::ip::tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0)};

  Page() { spdlog::set_level(spdlog::level::off); }
};

/// Keeps the timer of libFuzzer from interrupting a system call.
class WithoutAlarm {
 public:
  WithoutAlarm() {
    sigset_t alarm;
    sigemptyset(&alarm);
    sigaddset(&alarm, SIGALRM);
    pthread_sigmask(SIG_BLOCK, &alarm, &before_);
  }
  ~WithoutAlarm() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  WithoutAlarm(const WithoutAlarm&) = delete;
  WithoutAlarm& operator=(const WithoutAlarm&) = delete;

 private:
  sigset_t before_{};
};

/// One connection to the page.
class PageClient {
 public:
  explicit PageClient(Page& page) : page_(page), client_(page.io) {
    const WithoutAlarm connecting;
    client_.connect(page.acceptor.local_endpoint());
    client_.set_option(boost::asio::ip::tcp::no_delay(true));  // each message arrives before the page runs
    const auto session =
        std::make_shared<server::HttpSession>(page.site, page.acceptor.accept(), Endpoint{0x7F000001, 1});
    session->start();
    session_ = session;
    client_.non_blocking(true);
  }

  /// Sends all bytes, unless the page closes the connection, and reads what the page sends meanwhile.
  void send(std::string_view bytes) {
    boost::system::error_code error;
    while (!bytes.empty() && !error) {
      bytes.remove_prefix(client_.write_some(boost::asio::buffer(bytes), error));
      if (error == boost::asio::error::would_block) {
        error.clear();
      }
      run();
    }
  }

  /// Closes the connection. @return whether the page's side of it is gone, too
  bool leave() {
    boost::system::error_code error;
    client_.shutdown(boost::asio::ip::tcp::socket::shutdown_send, error);
    run();
    client_.close(error);
    run();
    return session_.expired();
  }

  const std::string& received() const { return received_; }

 private:
  /// Runs the page until it has no work, and reads.
  void run() {
    std::array<char, 65536> bytes{};
    boost::system::error_code error;
    for (bool more = true; more;) {
      page_.io.restart();
      more = page_.io.poll() > 0;
      if (client_.is_open()) {
        const std::size_t read = client_.read_some(boost::asio::buffer(bytes), error);
        received_.append(bytes.data(), read);
        more = read > 0 || more;
      }
    }
  }

  Page& page_;
  boost::asio::ip::tcp::socket client_;
  std::weak_ptr<server::HttpSession> session_;
  std::string received_;
};

}  // namespace sonard::fuzz
