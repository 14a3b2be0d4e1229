// SPDX-License-Identifier: Apache-2.0
// The page in the browser, /metrics and other endpoints, on threads of their own.
#pragma once

#include <memory>

#include "server/devices/ping_viewer.hpp"
#include "server/web/site.hpp"

namespace sonard::server {

/// One thread has all connections, and answers monitors while the other thread draws. Both have low
/// priorities, so that viewers do not slow down pings. show() is called on the I/O thread, everything else on
/// main.
class WebServer final : public PingViewer {
 public:
  /// Opens the port. @throws SocketError
  explicit WebServer(const WebConfig& config);
  /// Calls stop().
  ~WebServer() override;

  /// Serves from now on. Called once.
  void start(WebSources sources);
  /// Closes all connections and ends the threads. Can be called again.
  void stop();
  /// Runs a function on the page's thread. Any thread.
  void on_page(std::function<void()> task);

  /// "http://127.0.0.1:8014"
  std::string address() const;

  void show(std::shared_ptr<const ShownPing> ping) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonard::server
