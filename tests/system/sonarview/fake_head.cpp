// SPDX-License-Identifier: Apache-2.0
#include "tests/system/sonarview/fake_head.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "protocol/common/endpoint.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::test {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

micron::DeviceConfig FakeHead::quick() {
  micron::DeviceConfig config;
  config.alive_period = milliseconds{100};
  config.reconfiguration_time = nanoseconds{0};
  config.reposition_limit = nanoseconds{0};
  config.line_period = nanoseconds{0};
  return config;
}

FakeHead::FakeHead(server::SerialLinkConfig link, Settings settings)
    : link_config_(std::move(link)),
      settings_(std::move(settings)),
      device_(settings_.device, clock_.now() - seconds{20}) {
  open();
  // After vanishing, the line comes back at the same addresses.
  for (std::size_t i = 0; i < link_config_.tcp.size(); ++i) {
    link_config_.tcp[i].bind = link_->addresses().tcp[i];
    tcp_ = endpoint_text(link_config_.tcp[i].bind);
  }
  for (const Endpoint& endpoint : link_->addresses().udp) {
    udp_ = endpoint_text(endpoint);
  }
  for (const std::string& path : link_->addresses().pty) {
    tty_ = link_config_.pty.front().link.empty() ? path : link_config_.pty.front().link.string();
  }
  const Actions unheard = device_.step(clock_.now(), TimePassed{});  // no client is connected yet
  arm_timer(unheard.wake_at);
  thread_ = std::thread([this] { io_.run(); });
}

FakeHead::~FakeHead() {
  io_.stop();
  thread_.join();
}

void FakeHead::open() {
  link_ = std::make_unique<server::SerialLink>(io_, link_config_, clock_);
  link_->start(
      [this](std::span<const std::uint8_t> bytes, const std::string&) {
        step(BytesReceived{{}, SharedBytes(Bytes(bytes.begin(), bytes.end()))});
      },
      [this](const std::string&) { step(ClientGone{}); });
}

void FakeHead::vanish() {
  link_.reset();
  pieces_.clear();
  away_timer_.expires_after(settings_.away);
  away_timer_.async_wait([this](const boost::system::error_code& cancelled) {
    if (!cancelled) {
      open();
    }
  });
}

void FakeHead::step(const Event& event) {
  Actions actions = device_.step(clock_.now(), event);
  send_all(actions);
  while (actions.render) {
    const PingJob job = *std::move(actions.render);
    pings_ = job.number + 1;
    if (settings_.vanish_at_ping == job.number) {
      vanish();
    }
    actions = device_.step(clock_.now(), PingRendered{echoes(job)});
    send_all(actions);
  }
  arm_timer(actions.wake_at);
}

PingImage FakeHead::echoes(const PingJob& job) const {
  constexpr double unit_rad = 2.0 * std::numbers::pi / micron::units_per_turn;
  const auto from_ahead = static_cast<int>(std::lround(job.bearing_rad / unit_rad));
  PingImage image;
  image.number = job.number;
  for (int bin = 0; bin < job.bins(); ++bin) {
    image.u8.push_back(settings_.echo(micron::wrapped(micron::bearing_ahead + from_ahead), bin));
  }
  return image;
}

void FakeHead::send_all(const Actions& actions) {
  for (const Outgoing& frame : actions.send) {
    send(Bytes(frame.bytes.begin(), frame.bytes.end()));
  }
}

void FakeHead::send(const Bytes& frame) {
  const bool idle = pieces_.empty();
  for (Bytes& piece : settings_.carry(frame)) {
    pieces_.push_back(std::move(piece));
  }
  if (idle) {
    send_piece();
  }
}

void FakeHead::send_piece() {
  if (pieces_.empty()) {
    return;
  }
  if (link_) {
    link_->send(pieces_.front());
  }
  piece_timer_.expires_after(milliseconds{1});
  piece_timer_.async_wait([this](const boost::system::error_code& cancelled) {
    if (!cancelled) {
      if (!pieces_.empty()) {
        pieces_.pop_front();
      }
      send_piece();
    }
  });
}

void FakeHead::arm_timer(const std::optional<TimePoint>& wake_at) {
  if (!wake_at) {
    timer_.cancel();
    return;
  }
  timer_.expires_at(server::to_steady(*wake_at));
  timer_.async_wait([this](const boost::system::error_code& cancelled) {
    if (!cancelled) {
      step(TimePassed{});
    }
  });
}

}  // namespace sonard::test
