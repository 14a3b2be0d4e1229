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
#include "server/web/http_session.hpp"

namespace sonard::server {

namespace asio = boost::asio;

namespace {

constexpr int nice_value = 19;
constexpr int most_pings_waiting = 64;  // where this thread gets no time, pings are not kept for it

}  // namespace

struct WebServer::Impl {
  explicit Impl(const WebConfig& web)
      : config(web), listener(std::make_shared<TcpListener>(io, "page", web.bind, web.allow)) {}

  void accept(asio::ip::tcp::socket socket, const Endpoint& peer) {
    if (site->open_connection()) {
      std::make_shared<HttpSession>(*site, std::move(socket), peer)->start();
    } else {
      listener->refuse(peer, "too many connections");
    }
  }

  void run() {
    setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), nice_value);
    for (bool again = true; again;) {
      again = false;
      try {
        io.run();
      } catch (const std::exception& error) {
        // The page is not worth the daemon: the connection at fault is lost, the others go on.
        spdlog::error("page: {}", error.what());
        again = true;
      }
    }
  }

  const WebConfig config;
  std::optional<Site> site;  // before what its connections are part of, so that it outlives them
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work{asio::make_work_guard(io)};
  std::shared_ptr<TcpListener> listener;
  std::atomic<bool> serving{false};
  std::atomic<int> pings_waiting{0};  // for this thread, which has the lowest priority
  std::thread thread;
};

WebServer::WebServer(const WebConfig& config) : impl_(std::make_unique<Impl>(config)) {
  impl_->listener->open();
}

WebServer::~WebServer() {
  stop();
}

void WebServer::start(WebSources sources) {
  impl_->site.emplace(impl_->config, std::move(sources));
  impl_->listener->start([impl = impl_.get()](asio::ip::tcp::socket socket, const Endpoint& peer) {
    impl->accept(std::move(socket), peer);
  });
  impl_->serving = true;
  impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
}

void WebServer::stop() {
  impl_->serving = false;
  if (!impl_->thread.joinable()) {
    return;
  }
  impl_->io.stop();  // not posted: it would wait until all pictures in the queue are drawn
  impl_->thread.join();
  impl_->listener->close();
  impl_->site->close_viewers();
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
