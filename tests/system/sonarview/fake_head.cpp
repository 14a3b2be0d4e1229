// SPDX-License-Identifier: Apache-2.0
#include "tests/system/sonarview/fake_head.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "server/config/addresses.hpp"

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
  // The line comes back where it was.
  for (std::size_t i = 0; i < link_config_.tcp.size(); ++i) {
    link_config_.tcp[i].bind = link_->addresses().tcp[i];
    tcp_ = server::endpoint_text(link_config_.tcp[i].bind);
  }
  for (const server::Endpoint& endpoint : link_->addresses().udp) {
    udp_ = server::endpoint_text(endpoint);
  }
  for (const std::string& path : link_->addresses().pty) {
    tty_ = link_config_.pty.front().link.empty() ? path : link_config_.pty.front().link.string();
  }
  device_.advance(clock_.now());
  device_.take_outgoing();  // what it said before anybody could hear it
  step();
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
        device_.on_bytes(clock_.now(), bytes);
        step();
      },
      [this](const std::string&) { device_.on_host_gone(); });
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

void FakeHead::step() {
  device_.advance(clock_.now());
  for (const Bytes& frame : device_.take_outgoing()) {
    send(frame);
  }
  while (const auto job = device_.take_job()) {
    pings_ = job->ping_number + 1;
    if (settings_.vanish_at_ping == job->ping_number) {
      vanish();
    }
    micron::MicronLine line{job->ping_number, {}};
    for (int bin = 0; bin < job->bins; ++bin) {
      line.samples.push_back(settings_.echo(job->bearing, bin));
    }
    device_.on_line(clock_.now(), line);
    device_.advance(clock_.now());
    for (const Bytes& frame : device_.take_outgoing()) {
      send(frame);
    }
  }
  arm_timer();
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

void FakeHead::arm_timer() {
  const auto deadline = device_.next_deadline();
  if (!deadline) {
    timer_.cancel();
    return;
  }
  timer_.expires_at(server::to_steady(*deadline));
  timer_.async_wait([this](const boost::system::error_code& cancelled) {
    if (!cancelled) {
      step();
    }
  });
}

}  // namespace sonard::test
