// SPDX-License-Identifier: Apache-2.0
#include "server/net/serial_link.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>

#include "server/net/deadline_timer.hpp"
#include "server/net/line_pacer.hpp"
#include "server/net/pty_port.hpp"
#include "server/net/tcp_port.hpp"
#include "server/net/udp_port.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;

using Frame = std::vector<std::uint8_t>;

/// Bytes read from a client, or its departure.
struct Incoming {
  std::string peer;
  std::vector<std::uint8_t> bytes;  ///< empty: the client has left
};

std::optional<TimePoint> earlier(const std::optional<TimePoint>& one, const std::optional<TimePoint>& other) {
  return one && other ? std::min(one, other) : std::max(one, other);  // nullopt is less than any time
}

}  // namespace

struct SerialLink::Impl : std::enable_shared_from_this<SerialLink::Impl> {
  /// The address that holds the line (lock_to_first).
  struct Holder {
    Ipv4 address = 0;
    TimePoint newest_bytes{};
  };

  Impl(asio::io_context& io, const SerialLinkConfig& config, const Clock& used_clock);

  void start();
  void stop();
  bool takes_from(Ipv4 address);
  void send(Frame frame);
  bool connected() const;
  void take(Incoming incoming);
  void pump();
  void deliver(const Incoming& incoming) const;
  void schedule();

  const Clock& clock;
  const bool lock_to_first;
  std::optional<Holder> holder;
  std::vector<std::unique_ptr<TcpPort>> tcp;
  std::vector<std::unique_ptr<UdpPort>> udp;
  std::vector<std::unique_ptr<PtyPort>> pty;
  std::vector<SerialPort*> ports;  // pointers to all of the above
  LinePacer<Frame> to_clients;
  LinePacer<Incoming> from_clients;
  DeadlineTimer timer;
  Receive receive;
  Left left;
  decltype(SerialPortEvents::passed) passed;
  decltype(SerialPortEvents::ended) ended;
  bool running = false;
  bool pumping = false;
  SerialLinkCounters counters;  // without the ports' counters, which counters() adds
};

SerialLink::Impl::Impl(asio::io_context& io, const SerialLinkConfig& config, const Clock& used_clock)
    : clock(used_clock),
      lock_to_first(config.lock_to_first),
      to_clients(config.baud, most_waiting_bytes),
      from_clients(config.baud, most_waiting_bytes),
      timer(io) {
  const auto open = [&](auto& list, auto port) {
    ports.push_back(port.get());
    list.push_back(std::move(port));
  };
  for (const SerialTcpConfig& item : config.tcp) {
    open(tcp, std::make_unique<TcpPort>(io, item, clock));
  }
  for (const SerialUdpConfig& item : config.udp) {
    open(udp, std::make_unique<UdpPort>(io, item));
  }
  for (std::size_t i = 0; i < config.pty.size(); ++i) {
    try {
      open(pty, std::make_unique<PtyPort>(io, config.pty[i]));
    } catch (PtyLinkError& error) {
      error.item = i;
      throw;
    }
  }
}

void SerialLink::Impl::start() {
  running = true;
  const std::weak_ptr<Impl> weak = weak_from_this();
  const SerialPortEvents events{[weak](Ipv4 address) {
                                  const auto self = weak.lock();
                                  return self && self->takes_from(address);
                                },
                                [weak](std::span<const std::uint8_t> bytes, const std::string& peer) {
                                  if (const auto self = weak.lock()) {
                                    self->take({peer, {bytes.begin(), bytes.end()}});
                                  }
                                },
                                [weak](const std::string& peer) {
                                  if (const auto self = weak.lock()) {
                                    self->take({peer, {}});
                                  }
                                },
                                passed, ended};
  for (SerialPort* port : ports) {
    spdlog::info("serial {}: waits for clients", port->description());
    port->start(events);
  }
}

void SerialLink::Impl::stop() {
  running = false;
  for (SerialPort* port : ports) {
    port->stop();
  }
  to_clients.clear();
  from_clients.clear();
  timer.cancel();
}

bool SerialLink::Impl::takes_from(Ipv4 address) {
  if (!lock_to_first) {
    return true;
  }
  const TimePoint now = clock.now();
  if (holder && holder->address != address && now - holder->newest_bytes < lock_timeout) {
    ++counters.locked_out;
    return false;
  }
  holder = Holder{address, now};
  return true;
}

bool SerialLink::Impl::connected() const {
  return std::any_of(ports.begin(), ports.end(), [](const SerialPort* port) { return port->connected(); });
}

void SerialLink::Impl::send(Frame frame) {
  if (!running || frame.empty()) {
    return;
  }
  if (!connected()) {
    ++counters.frames_unheard;
    return;
  }
  const std::size_t size = frame.size();
  if (!to_clients.push(clock.now(), std::move(frame), size)) {
    ++counters.frames_overflowed;
    return;
  }
  pump();
}

void SerialLink::Impl::take(Incoming incoming) {
  const std::size_t size = incoming.bytes.size();
  if (!from_clients.push(clock.now(), std::move(incoming), size)) {
    counters.bytes_overrun += size;
    return;
  }
  if (!connected()) {
    // Frames for clients that have left must not reach the next client.
    counters.frames_unheard += to_clients.waiting();
    to_clients.clear();
  }
  pump();
}

// Processes everything that is due and sleeps until the next deadline. A callback may send, which the loop
// handles afterwards, or stop the link.
void SerialLink::Impl::pump() {
  if (pumping) {
    return;
  }
  const std::shared_ptr<Impl> self = shared_from_this();
  pumping = true;
  std::optional<Incoming> incoming;
  do {
    const TimePoint now = clock.now();
    while (const std::optional<Frame> frame = to_clients.pop_due(now)) {
      for (SerialPort* port : ports) {
        port->send(*frame);
      }
    }
    incoming = from_clients.pop_due(now);
    if (incoming) {
      deliver(*incoming);
    }
  } while (incoming);
  pumping = false;
  if (running) {
    schedule();
  }
}

void SerialLink::Impl::deliver(const Incoming& incoming) const {
  if (incoming.bytes.empty()) {
    left(incoming.peer);
  } else {
    receive(incoming.bytes, incoming.peer);
  }
}

void SerialLink::Impl::schedule() {
  const std::optional<TimePoint> deadline = earlier(to_clients.next_due(), from_clients.next_due());
  timer.set(deadline, [weak = weak_from_this()] {
    const auto self = weak.lock();
    if (self && self->running) {
      self->timer.passed();
      self->pump();
    }
  });
}

std::string serial_text(const SerialLinkConfig& config) {
  std::vector<std::string> ways;
  for (const SerialTcpConfig& tcp : config.tcp) {
    ways.push_back("TCP " + endpoint_text(tcp.bind));
  }
  for (const SerialUdpConfig& udp : config.udp) {
    ways.push_back("UDP " + endpoint_text(udp.bind));
  }
  for (const SerialPtyConfig& pty : config.pty) {
    ways.push_back(pty.link.empty() ? "a pty" : "a pty at " + pty.link.string());
  }
  return fmt::format("{}", fmt::join(ways, ", "));
}

SerialLink::SerialLink(asio::io_context& io, const SerialLinkConfig& config, const Clock& clock)
    : impl_(std::make_shared<Impl>(io, config, clock)) {}

SerialLink::~SerialLink() {
  impl_->stop();
}

void SerialLink::start(Receive receive, Left left, decltype(SerialPortEvents::passed) passed,
                       decltype(SerialPortEvents::ended) ended) {
  impl_->receive = std::move(receive);
  impl_->left = std::move(left);
  impl_->passed = std::move(passed);
  impl_->ended = std::move(ended);
  impl_->start();
}

void SerialLink::stop() {
  impl_->stop();
}

void SerialLink::send(Frame frame) {
  impl_->send(std::move(frame));
}

bool SerialLink::connected() const {
  return impl_->connected();
}

SerialAddresses SerialLink::addresses() const {
  SerialAddresses addresses;
  for (const auto& port : impl_->tcp) {
    addresses.tcp.push_back(port->local_endpoint());
  }
  for (const auto& port : impl_->udp) {
    addresses.udp.push_back(port->local_endpoint());
  }
  for (const auto& port : impl_->pty) {
    addresses.pty.push_back(port->path());
  }
  return addresses;
}

std::vector<std::string> SerialLink::descriptions() const {
  std::vector<std::string> lines;
  for (const SerialPort* port : impl_->ports) {
    lines.push_back(port->description());
  }
  return lines;
}

SerialLinkCounters SerialLink::counters() const {
  SerialLinkCounters total = impl_->counters;
  for (const SerialPort* port : impl_->ports) {
    const SerialPortCounters one = port->counters();
    total.ports.connections += one.connections;
    total.ports.refused += one.refused;
    total.ports.bytes_in += one.bytes_in;
    total.ports.bytes_out += one.bytes_out;
    total.ports.frames_dropped += one.frames_dropped;
    total.ports.frames_lost += one.frames_lost;
    total.each.push_back({port->description(), one});
  }
  return total;
}

}  // namespace sonard::server
