// SPDX-License-Identifier: Apache-2.0
#include "server/net/udp_transport.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>

#include "server/net/deadline_timer.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;

constexpr std::size_t most_unauthorised = 8;

void keep_earlier(std::optional<TimePoint>& earliest, const std::optional<TimePoint>& other) {
  if (other && (!earliest || *other < *earliest)) {
    earliest = other;
  }
}

}  // namespace

struct UdpTransport::Impl : std::enable_shared_from_this<UdpTransport::Impl> {
  Impl(asio::io_context& used_io, const Clock& used_clock, const UdpTransportConfig& used_config);

  std::unique_ptr<UdpEndpoint> open(const Endpoint& bind) const;
  void listen();
  void take(const Datagram& datagram);
  void tell_unauthorised(Ipv4 address);
  void pass_due();
  void schedule();
  void add_datagrams(const Outgoing& message, std::vector<Datagram>& datagrams) const;
  WirePassed passed(std::span<const Datagram> datagrams, bool to_client) const;

  asio::io_context& io;
  const Clock& clock;
  const UdpTransportConfig config;
  std::unique_ptr<UdpEndpoint> socket;
  FaultyLink to_client;
  FaultyLink from_client;
  DeadlineTimer timer;
  TransportEvents events;
  std::vector<Endpoint> everybody;
  Ipv4 everybody_from = 0;
  Ipv4 own_address = 0;
  std::uint64_t not_allowed = 0;
  std::set<Ipv4> unauthorised;
  bool running = false;
  bool passing = false;
};

UdpTransport::Impl::Impl(asio::io_context& used_io, const Clock& used_clock,
                         const UdpTransportConfig& used_config)
    : io(used_io),
      clock(used_clock),
      config(used_config),
      socket(open(config.bind)),
      to_client(config.link.to_client, config.link.seed),
      from_client(config.link.from_client, ~config.link.seed),  // independent of to_client
      timer(io) {}

std::unique_ptr<UdpEndpoint> UdpTransport::Impl::open(const Endpoint& bind) const {
  auto opened = std::make_unique<UdpEndpoint>(io, bind);
  if (config.multicast_ttl > 0) {
    opened->set_multicast_ttl(config.multicast_ttl);
  }
  return opened;
}

// Handlers hold the transport weakly: a queued handler does nothing once the transport is gone.
void UdpTransport::Impl::listen() {
  UdpEndpoint::Sent sent;
  if (events.passed) {
    sent = [weak = weak_from_this()](std::span<const Datagram> datagrams) {
      if (const auto self = weak.lock()) {
        self->events.passed(self->passed(datagrams, /*to_client=*/true));
      }
    };
  }
  socket->start(
      [weak = weak_from_this()](const Datagram& datagram) {
        if (const auto self = weak.lock()) {
          self->take(datagram);
        }
      },
      [weak = weak_from_this()] {
        if (const auto self = weak.lock(); self && self->running) {
          self->events.writable();
        }
      },
      std::move(sent));
}

void UdpTransport::Impl::take(const Datagram& datagram) {
  if (!allows(config.allow, datagram.remote.address)) {
    ++not_allowed;
    tell_unauthorised(datagram.remote.address);
    return;
  }
  if (events.passed) {
    events.passed(passed({&datagram, 1}, /*to_client=*/false));
  }
  from_client.push(clock.now(), datagram);
  pass_due();
}

void UdpTransport::Impl::tell_unauthorised(Ipv4 address) {
  if (unauthorised.size() < most_unauthorised && unauthorised.insert(address).second) {
    events.notice({Notice::Level::warning, fmt::format("drops datagrams of {}: the address is not in `allow`",
                                                       address_text(address))});
  }
}

// Passes on the datagrams that the link's faults have delayed until now, and sleeps until the next. Messages
// in response to one of them are sent after the last of them.
void UdpTransport::Impl::pass_due() {
  if (std::exchange(passing, true)) {
    return;
  }
  const TimePoint now = clock.now();
  for (Datagram& datagram : from_client.take_due(now)) {
    if (running) {
      events.received({{0, datagram.remote, datagram.local}, std::move(datagram.bytes)});
    }
  }
  passing = false;
  if (running) {
    socket->send(to_client.take_due(now));
    schedule();
  }
}

void UdpTransport::Impl::schedule() {
  std::optional<TimePoint> deadline = from_client.next_due();
  keep_earlier(deadline, to_client.next_due());
  timer.set(deadline, [weak = weak_from_this()] {
    if (const auto self = weak.lock(); self && self->running) {
      self->timer.passed();
      self->pass_due();
    }
  });
}

void UdpTransport::Impl::add_datagrams(const Outgoing& message, std::vector<Datagram>& datagrams) const {
  if (message.to == Outgoing::To::peer) {
    datagrams.push_back({message.peer.remote, message.peer.local, message.bytes});
    return;
  }
  for (const Endpoint& host : everybody) {
    datagrams.push_back({host, everybody_from, message.bytes});
  }
}

WirePassed UdpTransport::Impl::passed(std::span<const Datagram> datagrams, bool to_client_side) const {
  WirePassed wire{.to_client = to_client_side, .transport = WireTransport::udp, .pty = {}, .pieces = {}};
  const Endpoint local = socket->local_endpoint();
  wire.pieces.reserve(datagrams.size());
  for (const Datagram& datagram : datagrams) {
    const Ipv4 bound = local.address != 0 ? local.address : own_address;
    wire.pieces.push_back(
        {datagram.remote, {datagram.local != 0 ? datagram.local : bound, local.port}, datagram.bytes});
  }
  return wire;
}

UdpTransport::UdpTransport(asio::io_context& io, const Clock& clock, const UdpTransportConfig& config)
    : impl_(std::make_shared<Impl>(io, clock, config)) {}

UdpTransport::~UdpTransport() {
  stop();
}

void UdpTransport::start(TransportEvents events) {
  impl_->events = std::move(events);
  impl_->running = true;
  impl_->listen();
}

void UdpTransport::stop() {
  impl_->running = false;
  impl_->timer.cancel();
  impl_->socket->close();
}

void UdpTransport::send(std::vector<Outgoing> messages) {
  std::vector<Datagram> datagrams;
  datagrams.reserve(messages.size());
  for (const Outgoing& message : messages) {
    impl_->add_datagrams(message, datagrams);
  }
  if (impl_->config.link.to_client.transparent()) {
    impl_->socket->send(std::move(datagrams));  // the hot path: a batch stays a batch
    return;
  }
  const TimePoint now = impl_->clock.now();
  for (Datagram& datagram : datagrams) {
    impl_->to_client.push(now, std::move(datagram));
  }
  impl_->pass_due();
}

bool UdpTransport::blocked() const {
  return impl_->socket->blocked();
}

std::vector<std::string> UdpTransport::descriptions() const {
  return {"udp " + endpoint_text(local_endpoint())};
}

std::string UdpTransport::faults() const {
  return faults_text(impl_->config.link);
}

std::vector<Counter> UdpTransport::counts() const {
  std::vector<Counter> counts = udp_counters(impl_->socket->counters(), impl_->not_allowed);
  for (const FaultyLink* link : {&impl_->to_client, &impl_->from_client}) {
    const FaultyLinkCounters& faults = link->counters();
    if (faults.lost + faults.duplicated + faults.reordered > 0) {
      std::ranges::move(link_counters(faults, link == &impl_->to_client), std::back_inserter(counts));
    }
  }
  return counts;
}

std::vector<Counter> udp_counters(const UdpEndpointCounters& socket, std::uint64_t not_allowed) {
  return {{"sent", socket.sent, "datagrams sent"},
          {"received", socket.received, "datagrams received"},
          {"not_allowed", not_allowed, "datagrams of addresses outside `allow`, dropped",
           Counter::Fault::none, Counter::Shown::once},
          {"truncated", socket.truncated, "datagrams longer than any command, dropped"},
          {"kernel_dropped", socket.kernel_dropped, "datagrams lost because this machine is too busy"},
          {"blocked", socket.blocked, "times that sending had to wait for the network"},
          {"send_failed", socket.send_failed, "datagrams that the system refused to send (no route)"},
          {"overflowed", socket.overflowed, "datagrams dropped because too many waited"}};
}

std::vector<Counter> link_counters(const FaultyLinkCounters& link, bool to_client) {
  const std::string direction = to_client ? "to_client" : "from_client";
  return {{direction + "_passed", link.passed, "datagrams that left the `link`, with second copies"},
          {direction + "_lost", link.lost, "datagrams that the faults of `link` lost"},
          {direction + "_duplicated", link.duplicated, "datagrams that `link` doubled"},
          {direction + "_reordered", link.reordered, "datagrams that `link` let another overtake"}};
}

void UdpTransport::set_everybody(std::vector<Endpoint> hosts, Ipv4 from) {
  impl_->everybody = std::move(hosts);
  impl_->everybody_from = from;
}

void UdpTransport::set_own_address(Ipv4 address) {
  impl_->own_address = address;
}

void UdpTransport::rebind(const Endpoint& bind) {
  impl_->socket = impl_->open(bind);
  if (impl_->running) {
    impl_->listen();
  }
}

Endpoint UdpTransport::local_endpoint() const {
  return impl_->socket->local_endpoint();
}

}  // namespace sonard::server
