// SPDX-License-Identifier: Apache-2.0
// A WebSocket that sends pings and status to one viewer, as fast as the viewer requests them.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>

#include "server/web/web_socket.hpp"

namespace sonard::server {

/// Belongs to the page's thread. A viewer gets one ping, or one status, per request. A hidden or slow viewer
/// requests nothing, and costs nothing. docs/page.md lists the messages.
class LiveSession final : public WebSocket {
 public:
  LiveSession(Site& site, boost::beast::tcp_stream stream, const Endpoint& peer);

  void show(const std::shared_ptr<const ShownPing>& ping) override;
  void close() override;

 private:
  /// A viewer's request for one head.
  struct Wanted {
    bool asked = false;  ///< requested and not yet answered
    int max_rows = 1;
    TimePoint answered{};
    Pings pings;  ///< since the last answer, as in Site::last_pings()
  };

  void take(const std::string& text) override;
  void want(int head, int max_rows);
  bool is_due(const Wanted& wanted) const;
  void answer(Wanted& wanted);
  void send_status();
  void send_error(const std::string& text);

  std::map<int, Wanted> wanted_;  ///< by head
  bool status_asked_ = false;
  TimePoint status_sent_{};
  boost::asio::steady_timer status_timer_;
};

}  // namespace sonard::server
