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
constexpr std::size_t most_lines = 400;  // of a scanning head: one sweep of its finest steps
constexpr int most_rows = 4096;
constexpr std::chrono::milliseconds status_interval{500};

}  // namespace

LiveSession::LiveSession(Site& site, boost::beast::tcp_stream stream)
    : WebSocket(site, std::move(stream), "", most_message_bytes), status_timer_(executor()) {}

void LiveSession::close() {
  status_timer_.cancel();
  WebSocket::close();
}

// ---- What the viewer asks for

void LiveSession::take(const std::string& text) {
  const auto message = nlohmann::json::parse(text, nullptr, false);
  const std::string type = message.is_object() ? message.value("type", nlohmann::json()).dump() : "";
  if (type == "\"want\"" && message.value("head", nlohmann::json()).is_number_unsigned() &&
      message.value("max_rows", nlohmann::json()).is_number_unsigned()) {
    const auto head = message["head"].get<std::size_t>();
    if (head < Site::most_heads) {
      Wanted& wanted = wanted_[head];
      wanted.asked = true;
      wanted.max_rows =
          static_cast<int>(std::clamp<std::uint64_t>(message["max_rows"].get<std::uint64_t>(), 1, most_rows));
      site().want(head);
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

// ---- What it gets

bool LiveSession::is_due(const Wanted& wanted) const {
  return wanted.asked && has_room() && site().now() - wanted.answered >= site().interval();
}

void LiveSession::show(const std::shared_ptr<const ShownPing>& ping) {
  const auto found = wanted_.find(static_cast<std::size_t>(ping->head));
  if (found == wanted_.end()) {
    return;
  }
  Wanted& wanted = found->second;
  const bool scanning = ping->record.settings.beams == 1;
  if (scanning) {
    keep_line(wanted, ping);
  }
  if (!is_due(wanted)) {
    return;
  }
  wanted.asked = false;
  wanted.answered = site().now();
  if (scanning) {
    const auto lines = std::exchange(wanted.lines, {});
    send({std::make_shared<const std::string>(live_frame(lines, wanted.max_rows)), true});
  } else {
    send({site().frame_of(ping, wanted.max_rows), true});
  }
}

void LiveSession::keep_line(Wanted& wanted, const std::shared_ptr<const ShownPing>& ping) const {
  const auto size_of = [](const ShownPing& of) {
    return std::pair(of.record.settings.bins, of.record.settings.bin_m);
  };
  if (!wanted.lines.empty() && size_of(*wanted.lines.back()) != size_of(*ping)) {
    wanted.lines.clear();
  }
  if (wanted.lines.size() == most_lines) {
    wanted.lines.erase(wanted.lines.begin());
  }
  wanted.lines.push_back(ping);
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
