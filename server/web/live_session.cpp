// SPDX-License-Identifier: Apache-2.0
#include "server/web/live_session.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "server/web/json.hpp"
#include "server/web/live_frame.hpp"

namespace sonard::server {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {

constexpr std::size_t most_message_bytes = 4096;
constexpr std::size_t most_queued = 4;   // a viewer that reads too slowly gets nothing more
constexpr std::size_t most_lines = 400;  // of a scanning head: one sweep of its finest steps
constexpr int most_rows = 4096;
constexpr std::chrono::milliseconds status_interval{500};

}  // namespace

LiveSession::LiveSession(Site& site, beast::tcp_stream stream)
    : site_(site), socket_(std::move(stream)), status_timer_(socket_.get_executor()) {
  // A viewer that is gone without a word is noticed by its silence to our pings.
  socket_.set_option(
      websocket::stream_base::timeout{std::chrono::seconds{10}, std::chrono::seconds{20}, true});
  socket_.read_message_max(most_message_bytes);
}

LiveSession::~LiveSession() {
  site_.close_connection();
}

void LiveSession::start(HttpRequest request) {
  const auto kept = std::make_shared<HttpRequest>(std::move(request));
  socket_.async_accept(*kept, [self = shared_from_this(), kept](beast::error_code error) {
    if (!error) {
      self->read();
    }
  });
}

void LiveSession::close() {
  status_timer_.cancel();
  beast::error_code ignored;
  socket_.next_layer().socket().close(ignored);
}

// ---- What the viewer asks for

void LiveSession::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (error) {
      self->close();
      return;
    }
    const std::string text = beast::buffers_to_string(self->buffer_.data());
    self->buffer_.consume(self->buffer_.size());
    self->take(text);
    self->read();
  });
}

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
      site_.want(head);
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
  return wanted.asked && queue_.size() < most_queued && site_.now() - wanted.answered >= site_.interval();
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
  wanted.answered = site_.now();
  if (scanning) {
    const auto lines = std::exchange(wanted.lines, {});
    send({std::make_shared<const std::string>(live_frame(lines, wanted.max_rows)), true});
  } else {
    send({site_.frame_of(ping, wanted.max_rows), true});
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
  const auto wait = std::max(TimePoint{0}, status_sent_ + status_interval - site_.now());
  status_timer_.expires_after(wait);
  status_timer_.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
    const auto self = weak.lock();
    if (!self || error) {
      return;
    }
    self->site_.with_status_text([weak](const std::shared_ptr<const std::string>& text) {
      if (const auto session = weak.lock()) {
        session->status_asked_ = false;
        session->status_sent_ = session->site_.now();
        session->send(
            {std::make_shared<const std::string>(R"({"type":"status","status":)" + *text + "}"), false});
      }
    });
  });
}

void LiveSession::send_error(const std::string& text) {
  send({std::make_shared<const std::string>(text_of({{"type", "error"}, {"text", text}})), false});
}

void LiveSession::send(Message message) {
  if (queue_.size() >= most_queued) {
    return;
  }
  queue_.push_back(std::move(message));
  if (queue_.size() == 1) {
    write();
  }
}

void LiveSession::write() {
  const Message& message = queue_.front();
  socket_.binary(message.binary);
  socket_.async_write(boost::asio::buffer(*message.bytes),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        self->queue_.pop_front();
                        if (error) {
                          self->close();
                        } else if (!self->queue_.empty()) {
                          self->write();
                        }
                      });
}

}  // namespace sonard::server
