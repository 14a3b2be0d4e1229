// SPDX-License-Identifier: Apache-2.0
#include "server/net/udp_port.hpp"

#include <bit>
#include <optional>
#include <utility>

#include <spdlog/spdlog.h>

#include "server/net/addresses.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {

struct UdpPort::Impl : std::enable_shared_from_this<UdpPort::Impl> {
  Impl(boost::asio::io_context& io, const SerialUdpConfig& config)
      : socket(io, config.bind), allow(config.allow) {}

  void on_datagram(const Datagram& datagram);
  void meet(const Datagram& datagram);
  void stop();
  /// Requires a peer.
  WireEnds ends() const {
    const Endpoint local = socket.local_endpoint();
    return {WireTransport::udp, *peer, {reply_from != 0 ? reply_from : local.address, local.port}, {}};
  }
  std::string description() const { return "udp " + endpoint_text(socket.local_endpoint()); }

  UdpEndpoint socket;
  AllowList allow;
  SerialPortEvents events;
  std::optional<Endpoint> peer;
  std::string peer_name;
  Ipv4 reply_from = 0;
  bool running = false;
  SerialPortCounters counters;
  PeerLog log;
};

void UdpPort::Impl::on_datagram(const Datagram& datagram) {
  if (!allows(allow, datagram.remote.address)) {
    if (std::has_single_bit(++counters.refused)) {
      spdlog::warn("serial {}: datagram from {} dropped: not in the allow list ({} so far)", description(),
                   endpoint_text(datagram.remote), counters.refused);
    }
    return;
  }
  if (running && !events.takes(datagram.remote.address)) {
    return;
  }
  if (peer != datagram.remote) {
    meet(datagram);
  }
  reply_from = datagram.local;
  counters.bytes_in += datagram.bytes.size();
  if (running && events.passed) {
    events.passed(ends(), /*to_client=*/false, datagram.bytes);
  }
  if (running) {
    events.received(datagram.bytes, peer_name);
  }
}

void UdpPort::Impl::meet(const Datagram& datagram) {
  const std::string before = std::exchange(peer_name, "udp " + endpoint_text(datagram.remote));
  const bool had_peer = std::exchange(peer, datagram.remote).has_value();
  ++counters.connections;
  log.info("serial {}: replies go to {} from now on", description(), peer_name);
  if (had_peer) {
    events.left(before);
  }
}

void UdpPort::Impl::stop() {
  running = false;
  peer.reset();
  socket.close();
}

UdpPort::UdpPort(boost::asio::io_context& io, const SerialUdpConfig& config)
    : impl_(std::make_shared<Impl>(io, config)) {}

UdpPort::~UdpPort() {
  impl_->stop();
}

void UdpPort::start(SerialPortEvents events) {
  impl_->events = std::move(events);
  impl_->running = true;
  impl_->socket.start([weak = impl_->weak_from_this()](const Datagram& datagram) {
    if (const auto self = weak.lock()) {
      self->on_datagram(datagram);
    }
  });
}

void UdpPort::stop() {
  impl_->stop();
}

void UdpPort::send(std::span<const std::uint8_t> frame) {
  if (!impl_->peer) {
    return;
  }
  if (impl_->socket.blocked()) {
    ++impl_->counters.frames_dropped;
    return;
  }
  impl_->counters.bytes_out += frame.size();
  const SharedBytes bytes(std::vector<std::uint8_t>(frame.begin(), frame.end()));
  if (impl_->events.passed) {
    impl_->events.passed(impl_->ends(), /*to_client=*/true, frame);
  }
  impl_->socket.send({{*impl_->peer, impl_->reply_from, bytes}});
}

bool UdpPort::connected() const {
  return impl_->peer.has_value();
}

std::string UdpPort::description() const {
  return impl_->description();
}

SerialPortCounters UdpPort::counters() const {
  SerialPortCounters counters = impl_->counters;
  counters.refused += impl_->socket.counters().truncated;
  counters.frames_lost += impl_->socket.counters().send_failed;
  return counters;
}

Endpoint UdpPort::local_endpoint() const {
  return impl_->socket.local_endpoint();
}

}  // namespace sonard::server
