// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/sockets.hpp"

#include <fmt/format.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/address_v4.hpp>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "protocol/gemini/messages.hpp"

namespace sonard::client {
namespace {

using boost::asio::ip::address_v4;
using boost::asio::ip::udp;
using boost::system::error_code;

constexpr std::size_t longest_datagram = 2048;  // as in the vendor's libraries
constexpr int receive_buffer_bytes = 16 << 20;  // as later versions of the vendor's libraries request

const char* advice(const error_code& error, std::uint16_t port) {
  if (error == boost::asio::error::address_in_use) {
    return port == gemini::client_port
               ? "; another client of a sonar is running on this machine (ss -ulpn 'sport = :52900' shows it)"
               : "; another client, or a head that serves all addresses, runs on this machine (ss -ulpn "
                 "'sport = :52901' shows it)";
  }
  if (error == boost::system::errc::address_not_available) {
    return "; no interface of this machine has that address (ip address shows them)";
  }
  return "";
}

udp::socket open(boost::asio::io_context& io, Ipv4 address, std::uint16_t port, const char* purpose) {
  udp::socket socket(io);
  error_code error;
  socket.open(udp::v4(), error);
  if (!error) {
    socket.bind({address_v4(address), port}, error);
  }
  if (!error) {
    socket.non_blocking(true, error);
  }
  if (error) {
    throw std::runtime_error(fmt::format("cannot {} {}:{}: {}{}", purpose, address_text(address), port,
                                         error.message(), advice(error, port)));
  }
  return socket;
}

}  // namespace

GeminiSockets::GeminiSockets(Ipv4 bind, Ipv4 own)
    : reports_(open(io_, bind, gemini::client_port, "receive on")),
      commands_(io_),
      own_(own),
      buffer_(longest_datagram) {
  const int descriptor = reports_.native_handle();
  const int wanted = receive_buffer_bytes;
  // Only privileged processes may exceed the system's limit. A smaller buffer only means more retries.
  if (setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted) != 0) {
    setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  }
  const int on = 1;  // if it fails, kernel_drops() stays 0
  setsockopt(descriptor, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  if (own_ != 0) {
    commands_ = open(io_, own_, gemini::head_port, "send from");
  }
}

void GeminiSockets::open_towards(Ipv4 head) {
  if (!commands_.is_open()) {
    own_ = address_towards(head);
    commands_ = open(io_, own_, gemini::head_port, "send from");
  }
}

std::optional<std::span<const std::uint8_t>> GeminiSockets::receive() {
  alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(sizeof(std::uint32_t))] = {};
  iovec part{buffer_.data(), buffer_.size()};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  const ssize_t size = recvmsg(reports_.native_handle(), &message, MSG_DONTWAIT);
  if (size < 0) {
    return std::nullopt;
  }
  const cmsghdr* const info = CMSG_FIRSTHDR(&message);
  if (info != nullptr && info->cmsg_level == SOL_SOCKET && info->cmsg_type == SO_RXQ_OVFL) {
    std::uint32_t total = 0;
    std::memcpy(&total, CMSG_DATA(info), sizeof total);
    kernel_drops_ = total;
  }
  return std::span(buffer_).first(static_cast<std::size_t>(size));
}

error_code GeminiSockets::send(Ipv4 head, std::span<const std::uint8_t> datagram) {
  error_code error;
  commands_.send_to(boost::asio::buffer(datagram.data(), datagram.size()),
                    {address_v4(head), gemini::head_port}, 0, error);
  return error;
}

Ipv4 address_towards(Ipv4 head) {
  boost::asio::io_context io;
  udp::socket probe(io);
  error_code error;
  probe.open(udp::v4(), error);
  if (!error) {
    probe.connect({address_v4(head), gemini::head_port}, error);  // sends nothing
  }
  if (error) {
    throw std::runtime_error(
        fmt::format("no route to the head at {}: {}", address_text(head), error.message()));
  }
  const Ipv4 own = probe.local_endpoint().address().to_v4().to_uint();
  return own == head ? INADDR_LOOPBACK : own;
}

std::optional<Ipv4> interface_netmask(Ipv4 address) {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) {
    return std::nullopt;
  }
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(first, &freeifaddrs);
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_netmask == nullptr ||
        entry->ifa_addr->sa_family != AF_INET) {
      continue;
    }
    sockaddr_in own{};
    sockaddr_in mask{};
    std::memcpy(&own, entry->ifa_addr, sizeof own);
    std::memcpy(&mask, entry->ifa_netmask, sizeof mask);
    if (ntohl(own.sin_addr.s_addr) == address) {
      return ntohl(mask.sin_addr.s_addr);
    }
  }
  return std::nullopt;
}

}  // namespace sonard::client
