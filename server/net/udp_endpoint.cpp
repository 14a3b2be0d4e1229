// SPDX-License-Identifier: Apache-2.0
#include "server/net/udp_endpoint.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "server/net/addresses.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;

constexpr std::size_t batch_size = 64;         // datagrams per system call
constexpr int receive_rounds_per_wake = 4;     // then other handlers get their turn on the I/O thread
constexpr int receive_buffer_bytes = 4 << 20;  // limited by net.core.rmem_max
// Small on purpose: on a slow link, datagrams then wait in the head, which can count them, not in the kernel.
constexpr int datagram_send_buffer_bytes = 256 << 10;

constexpr std::size_t receive_control_bytes =
    CMSG_SPACE(sizeof(in_pktinfo)) + CMSG_SPACE(sizeof(std::uint32_t));
constexpr std::size_t send_control_bytes = CMSG_SPACE(sizeof(in_pktinfo));

sockaddr_in to_sockaddr(const Endpoint& endpoint) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  address.sin_addr.s_addr = htonl(endpoint.address);
  return address;
}

Endpoint from_sockaddr(const sockaddr_in& address) {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

}  // namespace

void throw_socket_error(const std::string& operation, int error) {
  const std::string what = "cannot " + operation;
  if (error == EMFILE || error == ENFILE || error == ENOMEM || error == ENOBUFS) {
    throw std::system_error(error == ENOBUFS ? ENOMEM : error, std::generic_category(), what);
  }
  throw SocketError(what + ": " + std::generic_category().message(error));
}

namespace {

void set_option(int fd, int level, int name, int value, const char* what) {
  if (setsockopt(fd, level, name, &value, sizeof value) != 0) {
    throw_socket_error(fmt::format("set {}", what), errno);
  }
}

// Buffers for one recvmmsg() call; the kernel fills them, parse() reads them.
struct ReceiveBatch {
  struct alignas(cmsghdr) Control {
    std::array<char, receive_control_bytes> bytes;
  };
  explicit ReceiveBatch(std::size_t most_bytes_of_one)
      : most_bytes(most_bytes_of_one), data(batch_size * most_bytes_of_one) {}

  std::size_t most_bytes;
  std::vector<std::uint8_t> data;
  std::array<Control, batch_size> control;
  std::array<sockaddr_in, batch_size> from;
  std::array<iovec, batch_size> vectors;
  std::array<mmsghdr, batch_size> headers;

  std::uint8_t* datagram(std::size_t i) { return data.data() + i * most_bytes; }

  void prepare() {
    for (std::size_t i = 0; i < batch_size; ++i) {
      vectors[i] = {datagram(i), most_bytes};
      headers[i] = {};
      headers[i].msg_hdr.msg_name = &from[i];
      headers[i].msg_hdr.msg_namelen = sizeof from[i];
      headers[i].msg_hdr.msg_iov = &vectors[i];
      headers[i].msg_hdr.msg_iovlen = 1;
      headers[i].msg_hdr.msg_control = control[i].bytes.data();
      headers[i].msg_hdr.msg_controllen = control[i].bytes.size();
    }
  }
};

// Headers for one sendmmsg() call over the front of the queue.
struct SendBatch {
  struct alignas(cmsghdr) Control {
    std::array<char, send_control_bytes> bytes;
  };
  std::array<Control, batch_size> control;
  std::array<sockaddr_in, batch_size> to;
  std::array<iovec, batch_size> vectors;
  std::array<mmsghdr, batch_size> headers;

  void prepare(std::size_t i, const Datagram& datagram) {
    to[i] = to_sockaddr(datagram.remote);
    // The system call does not write through this pointer; iovec has no const variant.
    vectors[i] = {const_cast<std::uint8_t*>(datagram.bytes.data()), datagram.bytes.size()};
    headers[i] = {};
    msghdr& header = headers[i].msg_hdr;
    header.msg_name = &to[i];
    header.msg_namelen = sizeof to[i];
    header.msg_iov = &vectors[i];
    header.msg_iovlen = 1;
    if (datagram.local == 0) {
      return;
    }
    header.msg_control = control[i].bytes.data();
    header.msg_controllen = send_control_bytes;
    control[i].bytes.fill(0);
    cmsghdr* source = CMSG_FIRSTHDR(&header);
    source->cmsg_level = IPPROTO_IP;
    source->cmsg_type = IP_PKTINFO;
    source->cmsg_len = CMSG_LEN(sizeof(in_pktinfo));
    in_pktinfo info{};
    info.ipi_spec_dst.s_addr = htonl(datagram.local);
    std::memcpy(CMSG_DATA(source), &info, sizeof info);
  }
};

}  // namespace

struct UdpEndpoint::Impl : std::enable_shared_from_this<UdpEndpoint::Impl> {
  Impl(asio::io_context& io, std::size_t most_bytes) : socket(io), incoming(most_bytes) {}

  udp::socket socket;
  Endpoint local;
  Receive receive;
  std::function<void()> drained;
  Sent sent_hook;
  std::deque<Datagram> queue;
  bool waiting_to_write = false;
  std::set<int> reported_errors;
  UdpEndpointCounters counters;
  ReceiveBatch incoming;
  SendBatch outgoing;

  void open(const Endpoint& bind, Sharing sharing);
  void wait_readable();
  void on_readable();
  bool receive_batch();
  void deliver(std::size_t i);
  void wait_writable();
  void flush();
  bool send_batch();
  void drop_front(int error);
};

UdpEndpoint::UdpEndpoint(asio::io_context& io, const Endpoint& bind, Sharing sharing, std::size_t most_bytes)
    : impl_(std::make_shared<Impl>(io, most_bytes)) {
  impl_->open(bind, sharing);
}

UdpEndpoint::~UdpEndpoint() {
  close();
}

void UdpEndpoint::Impl::open(const Endpoint& bind, Sharing sharing) {
  boost::system::error_code error;
  socket.open(udp::v4(), error);
  if (error) {
    throw_socket_error("open a UDP socket", error.value());
  }
  const int fd = socket.native_handle();
  set_option(fd, SOL_SOCKET, SO_BROADCAST, 1, "SO_BROADCAST");
  // Optional: without it, in some sandboxes and emulators, datagrams dropped by the kernel are not counted.
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  set_option(fd, IPPROTO_IP, IP_PKTINFO, 1, "IP_PKTINFO");
  set_option(fd, SOL_SOCKET, SO_RCVBUF, receive_buffer_bytes, "SO_RCVBUF");
  set_option(fd, SOL_SOCKET, SO_SNDBUF, datagram_send_buffer_bytes, "SO_SNDBUF");
  if (sharing == Sharing::with_others) {
    set_option(fd, SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR");
  }
  socket.bind({asio::ip::address_v4(bind.address), bind.port}, error);
  if (error) {
    throw_socket_error("bind UDP " + endpoint_text(bind), error.value());
  }
  socket.native_non_blocking(true, error);
  const udp::endpoint bound = error ? udp::endpoint() : socket.local_endpoint(error);
  if (error) {
    throw_socket_error("use UDP " + endpoint_text(bind), error.value());
  }
  local = {bound.address().to_v4().to_uint(), bound.port()};
}

void UdpEndpoint::start(Receive receive, std::function<void()> drained, Sent sent) {
  impl_->receive = std::move(receive);
  impl_->drained = std::move(drained);
  impl_->sent_hook = std::move(sent);
  impl_->wait_readable();
}

void UdpEndpoint::set_multicast_ttl(int ttl) {
  const int fd = impl_->socket.native_handle();
  set_option(fd, IPPROTO_IP, IP_MULTICAST_TTL, ttl, "IP_MULTICAST_TTL");
  const in_addr own{htonl(impl_->local.address)};
  if (setsockopt(fd, IPPROTO_IP, IP_MULTICAST_IF, &own, sizeof own) != 0) {
    throw_socket_error("set IP_MULTICAST_IF", errno);
  }
  // Large datagrams leave in fragments, which routers may divide again.
  set_option(fd, IPPROTO_IP, IP_MTU_DISCOVER, IP_PMTUDISC_DONT, "IP_MTU_DISCOVER");
}

void UdpEndpoint::close() {
  boost::system::error_code ignored;
  impl_->socket.close(ignored);
  impl_->queue.clear();
}

Endpoint UdpEndpoint::local_endpoint() const {
  return impl_->local;
}
const UdpEndpointCounters& UdpEndpoint::counters() const {
  return impl_->counters;
}
bool UdpEndpoint::blocked() const {
  return !impl_->queue.empty();
}

void UdpEndpoint::Impl::wait_readable() {
  socket.async_wait(udp::socket::wait_read,
                    [self = shared_from_this()](const boost::system::error_code& error) {
                      if (!error && self->socket.is_open()) {
                        self->on_readable();
                      }
                    });
}

void UdpEndpoint::Impl::on_readable() {
  for (int round = 0; round < receive_rounds_per_wake && socket.is_open(); ++round) {
    if (!receive_batch()) {
      break;
    }
  }
  if (socket.is_open()) {
    wait_readable();
  }
}

// One system call. Returns false if there is nothing left to read.
bool UdpEndpoint::Impl::receive_batch() {
  incoming.prepare();
  const int count = recvmmsg(socket.native_handle(), incoming.headers.data(), batch_size, MSG_DONTWAIT,
                             /*timeout=*/nullptr);
  // Errors other than "empty" come from earlier sends (ICMP); the next call continues reading.
  for (int i = 0; i < count && socket.is_open(); ++i) {
    deliver(static_cast<std::size_t>(i));
  }
  return count == static_cast<int>(batch_size);
}

void UdpEndpoint::Impl::deliver(std::size_t i) {
  msghdr& header = incoming.headers[i].msg_hdr;
  ++counters.received;
  if ((header.msg_flags & MSG_TRUNC) != 0 || header.msg_namelen != sizeof(sockaddr_in)) {
    ++counters.truncated;
    return;
  }
  Datagram datagram;
  datagram.remote = from_sockaddr(incoming.from[i]);
  datagram.local = local.address;
  for (cmsghdr* item = CMSG_FIRSTHDR(&header); item != nullptr; item = CMSG_NXTHDR(&header, item)) {
    if (item->cmsg_level == IPPROTO_IP && item->cmsg_type == IP_PKTINFO) {
      in_pktinfo info{};
      std::memcpy(&info, CMSG_DATA(item), sizeof info);
      datagram.local = ntohl(info.ipi_spec_dst.s_addr);
    } else if (item->cmsg_level == SOL_SOCKET && item->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t total = 0;
      std::memcpy(&total, CMSG_DATA(item), sizeof total);
      counters.kernel_dropped = total;
    }
  }
  const std::uint8_t* bytes = incoming.datagram(i);
  datagram.bytes = SharedBytes(std::vector<std::uint8_t>(bytes, bytes + incoming.headers[i].msg_len));
  receive(datagram);
}

void UdpEndpoint::send(std::vector<Datagram> datagrams) {
  if (!impl_->socket.is_open()) {
    return;
  }
  for (Datagram& datagram : datagrams) {
    if (impl_->queue.size() >= most_queued) {
      ++impl_->counters.overflowed;
      continue;
    }
    impl_->queue.push_back(std::move(datagram));
  }
  if (!impl_->waiting_to_write) {
    impl_->flush();
  }
}

void UdpEndpoint::Impl::flush() {
  while (!queue.empty()) {
    if (!send_batch()) {
      ++counters.blocked;
      wait_writable();
      return;
    }
  }
}

void UdpEndpoint::Impl::wait_writable() {
  waiting_to_write = true;
  // Asio re-arms its epoll registration here, so a socket that drained meanwhile is not missed.
  socket.async_wait(udp::socket::wait_write,
                    [self = shared_from_this()](const boost::system::error_code& error) {
                      self->waiting_to_write = false;
                      if (error || !self->socket.is_open()) {
                        return;
                      }
                      self->flush();
                      if (self->queue.empty() && self->drained) {
                        self->drained();
                      }
                    });
}

// One system call. Returns false if the socket is full.
bool UdpEndpoint::Impl::send_batch() {
  const std::size_t count = std::min(queue.size(), batch_size);
  for (std::size_t i = 0; i < count; ++i) {
    outgoing.prepare(i, queue[i]);
  }
  const int sent =
      sendmmsg(socket.native_handle(), outgoing.headers.data(), static_cast<unsigned>(count), MSG_DONTWAIT);
  if (sent > 0) {
    counters.sent += static_cast<std::uint64_t>(sent);
    if (sent_hook) {
      const std::vector<Datagram> gone(queue.begin(), queue.begin() + sent);
      sent_hook(gone);
    }
    queue.erase(queue.begin(), queue.begin() + sent);
    return true;
  }
  if (errno == EAGAIN || errno == EWOULDBLOCK) {
    return false;
  }
  if (errno != EINTR) {
    drop_front(errno);
  }
  return true;
}

// The datagram at the front can never be sent: no route, no such source address, forbidden.
void UdpEndpoint::Impl::drop_front(int error) {
  ++counters.send_failed;
  if (reported_errors.insert(error).second) {
    spdlog::warn("cannot send from {} to {}: {} (reported once)", endpoint_text(local),
                 endpoint_text(queue.front().remote), std::generic_category().message(error));
  }
  queue.pop_front();
}

}  // namespace sonard::server
