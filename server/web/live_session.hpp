// SPDX-License-Identifier: Apache-2.0
// A WebSocket that shows pings and status to one viewer, as fast as that viewer asks for them.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>

#include "server/web/web_socket.hpp"

namespace sonard::server {

/// Belongs to the thread of the page. A viewer gets one ping, or one status, for each time it asked: one that
/// is hidden or slow asks for nothing, and costs nothing. docs/page.md lists the messages.
class LiveSession final : public WebSocket {
 public:
  LiveSession(Site& site, boost::beast::tcp_stream stream, const Endpoint& peer);

  void show(const std::shared_ptr<const ShownPing>& ping) override;
  void close() override;

 private:
  /// What this viewer wants of one head.
  struct Wanted {
    bool asked = false;  ///< and not answered
    int max_rows = 1;
    TimePoint answered{};
    Pings pings;  ///< since the last answer, as Site::last_pings()
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
