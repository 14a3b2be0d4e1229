// SPDX-License-Identifier: Apache-2.0
#include "server/web/live_session.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/web/json.hpp"
#include "server/web/live_frame.hpp"

namespace sonard::server {

namespace {

constexpr std::size_t most_message_bytes = 4096;
constexpr std::uint64_t most_heads = 64;
constexpr int most_rows = 4096;
constexpr std::chrono::milliseconds status_interval{500};

}  // namespace

LiveSession::LiveSession(Site& site, boost::beast::tcp_stream stream, const Endpoint& peer)
    : WebSocket(site, std::move(stream), peer, most_message_bytes), status_timer_(executor()) {}

void LiveSession::close() {
  status_timer_.cancel();
  WebSocket::close();
}

// ---- Requests of the viewer

void LiveSession::take(const std::string& text) {
  const auto message = json_of_peer(text);
  const std::string type = message.is_object() ? message.value("type", nlohmann::json()).dump() : "";
  if (type == "\"want\"" && message.value("head", nlohmann::json()).is_number_unsigned() &&
      message.value("max_rows", nlohmann::json()).is_number_unsigned()) {
    const auto head = message["head"].get<std::uint64_t>();
    if (head < most_heads) {
      want(static_cast<int>(head), static_cast<int>(std::clamp<std::uint64_t>(
                                       message["max_rows"].get<std::uint64_t>(), 1, most_rows)));
    }
  } else if (type == "\"want_status\"") {
    if (!std::exchange(status_asked_, true)) {
      send_status();
    }
  } else {
    send_error(
        "Expected {\"type\": \"want\", \"head\": 0, \"max_rows\": 600} or {\"type\": \"want_status\"}.");
  }
}

void LiveSession::want(int head, int max_rows) {
  const auto [place, is_new] = wanted_.try_emplace(head);
  Wanted& wanted = place->second;
  wanted.asked = true;
  wanted.max_rows = max_rows;
  if (is_new) {
    wanted.pings = site().last_pings(head);
    if (!wanted.pings.empty() && is_due(wanted)) {
      answer(wanted);
    }
  }
}

// ---- Messages to the viewer

bool LiveSession::is_due(const Wanted& wanted) const {
  return wanted.asked && has_room() && site().now() - wanted.answered >= site().interval();
}

void LiveSession::show(const std::shared_ptr<const ShownPing>& ping) {
  if (const auto found = wanted_.find(ping->head); found != wanted_.end()) {
    keep_newest(found->second.pings, ping);
    if (is_due(found->second)) {
      answer(found->second);
    }
  }
}

void LiveSession::answer(Wanted& wanted) {
  wanted.asked = false;
  wanted.answered = site().now();
  const Pings pings = std::exchange(wanted.pings, {});
  promise();
  site().with_frame(pings, wanted.max_rows, [weak = weak<LiveSession>()](const Text& frame) {
    if (const auto self = weak.lock()) {
      self->send_promised({"", frame, true});
    }
  });
}

void LiveSession::send_status() {
  const auto wait = std::max(TimePoint{0}, status_sent_ + status_interval - site().now());
  status_timer_.expires_after(wait);
  status_timer_.async_wait([weak = weak<LiveSession>()](const boost::system::error_code& error) {
    const auto self = weak.lock();
    if (!self || error) {
      return;
    }
    self->site().with_status_text([weak](const std::shared_ptr<const std::string>& text) {
      if (const auto session = weak.lock()) {
        session->status_asked_ = false;
        session->status_sent_ = session->site().now();
        session->send_text(R"({"type":"status","status":)" + *text + "}");
      }
    });
  });
}

void LiveSession::send_error(const std::string& text) {
  send_text(text_of({{"type", "error"}, {"text", text}}));
}

}  // namespace sonard::server
