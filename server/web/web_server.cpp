// SPDX-License-Identifier: Apache-2.0
#include "server/web/web_server.hpp"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <exception>
#include <optional>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "server/net/tcp_listener.hpp"
#include "server/net/tcp_options.hpp"
#include "server/web/http_session.hpp"

namespace sonard::server {

namespace asio = boost::asio;

namespace {

constexpr int page_nice = 10;
constexpr int drawing_nice = 19;
constexpr int send_buffer_bytes = 256 << 10;  // of a connection, in the kernel; Linux doubles it
constexpr int most_pings_waiting = 64;        // further pings are dropped while this thread gets no time

}  // namespace

struct WebServer::Impl {
  explicit Impl(const WebConfig& web)
      : config(web), listener(std::make_shared<TcpListener>(io, "web", web.bind, web.allow)) {}

  void accept(asio::ip::tcp::socket socket, const Endpoint& peer) {
    set_client_options(socket, send_buffer_bytes);
    std::make_shared<HttpSession>(*site, std::move(socket), peer)->start();
  }

  void draw(std::function<Text()> make, std::function<void(Text)> take) {
    asio::post(drawing_io, [this, make = std::move(make), take = std::move(take)]() mutable {
      Text made;
      try {
        made = make();
      } catch (const std::exception& error) {
        spdlog::error("web: cannot draw: {}", error.what());
      }
      make = nullptr;  // destroys its captures on this thread, before the next drawing
      asio::post(io, [take = std::move(take), made = std::move(made)] { take(made); });
    });
  }

  static void run(asio::io_context& io, int nice) {
    setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), nice);
    for (bool again = true; again;) {
      again = false;
      try {
        io.run();
      } catch (const std::exception& error) {
        // An error must not end the daemon: this connection is lost, the others continue.
        spdlog::error("web: {}", error.what());
        again = true;
      }
    }
  }

  const WebConfig config;
  std::optional<Site> site;  // declared before its connections' contexts, so that it outlives them
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work{asio::make_work_guard(io)};
  std::shared_ptr<TcpListener> listener;
  asio::io_context drawing_io{1};  // after io: its handlers may own sockets of io
  asio::executor_work_guard<asio::io_context::executor_type> drawing_work{asio::make_work_guard(drawing_io)};
  std::atomic<bool> serving{false};
  std::atomic<int> pings_waiting{0};  // for the page's thread, which has a low priority
  std::thread thread;
  std::thread drawing_thread;
};

WebServer::WebServer(const WebConfig& config) : impl_(std::make_unique<Impl>(config)) {
  impl_->listener->open();
}

WebServer::~WebServer() {
  stop();
}

void WebServer::start(WebSources sources) {
  impl_->site.emplace(impl_->config, std::move(sources),
                      [impl = impl_.get()](std::function<Text()> make, std::function<void(Text)> take) {
                        impl->draw(std::move(make), std::move(take));
                      });
  impl_->listener->start([impl = impl_.get()](asio::ip::tcp::socket socket, const Endpoint& peer) {
    impl->accept(std::move(socket), peer);
  });
  impl_->serving = true;
  impl_->thread = std::thread([impl = impl_.get()] { Impl::run(impl->io, page_nice); });
  impl_->drawing_thread = std::thread([impl = impl_.get()] { Impl::run(impl->drawing_io, drawing_nice); });
}

void WebServer::stop() {
  impl_->serving = false;
  if (!impl_->thread.joinable()) {
    return;
  }
  impl_->io.stop();  // not posted: that would wait for all queued handlers
  impl_->drawing_io.stop();
  impl_->thread.join();
  if (impl_->drawing_thread.joinable()) {
    impl_->drawing_thread.join();
  }
  impl_->listener->close();
  impl_->site->close();
}

void WebServer::on_page(std::function<void()> task) {
  asio::post(impl_->io, std::move(task));
}

std::string WebServer::address() const {
  return "http://" + endpoint_text(impl_->listener->local());
}

void WebServer::show(std::shared_ptr<const ShownPing> ping) {
  if (!impl_->serving || impl_->pings_waiting >= most_pings_waiting) {
    return;
  }
  ++impl_->pings_waiting;
  on_page([impl = impl_.get(), ping = std::move(ping)] {
    --impl->pings_waiting;
    impl->site->show(ping);
  });
}

}  // namespace sonard::server
