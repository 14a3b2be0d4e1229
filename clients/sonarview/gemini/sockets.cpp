// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/sockets.hpp"

#include <fmt/format.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <boost/asio/ip/address_v4.hpp>
#include <cstring>
#include <memory>

#include "protocol/common/endpoint.hpp"
#include "protocol/gemini/messages.hpp"

namespace sonard::client {
namespace {

using boost::asio::ip::udp;

constexpr int receive_buffer_bytes = 16 << 20;  // as later versions of the vendor's libraries request

/// Only privileged processes may exceed the system's limit; others get the limit.
void enlarge_receive_buffer(udp::socket& socket) {
  const int wanted = receive_buffer_bytes;
  if (setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted) != 0) {
    boost::system::error_code ignored;  // a smaller buffer only means more retries
    socket.set_option(boost::asio::socket_base::receive_buffer_size(wanted), ignored);
  }
}

const char* advice(const boost::system::error_code& error, std::uint16_t port) {
  if (error == boost::asio::error::address_in_use) {
    return port == gemini::client_port
               ? "; another client of a sonar is running on this machine (ss -ulpn 'sport = :52900' shows it)"
               : "; another client, or a head that serves all addresses, runs on this machine (ss -ulpn "
                 "'sport = "
                 ":52901' shows it)";
  }
  if (error == boost::system::errc::address_not_available) {
    return "; no interface of this machine has that address (ip address shows them)";
  }
  return "";
}

udp::socket open(boost::asio::io_context& io, std::uint32_t address, std::uint16_t port,
                 const char* purpose) {
  udp::socket socket(io);
  boost::system::error_code error;
  socket.open(udp::v4(), error);
  if (!error) {
    socket.bind({boost::asio::ip::address_v4(address), port}, error);
  }
  if (!error) {
    socket.non_blocking(true, error);
  }
  if (error) {
    throw SocketError(fmt::format("cannot {} {}:{}: {}{}", purpose, address_text(address), port,
                                  error.message(), advice(error, port)));
  }
  return socket;
}

}  // namespace

udp::socket open_report_socket(boost::asio::io_context& io, std::uint32_t address) {
  udp::socket socket = open(io, address, gemini::client_port, "receive on");
  enlarge_receive_buffer(socket);
  const int on = 1;
  setsockopt(socket.native_handle(), SOL_SOCKET, SO_RXQ_OVFL, &on,
             sizeof on);  // if it fails, overflows are not counted
  return socket;
}

udp::socket open_command_socket(boost::asio::io_context& io, std::uint32_t address) {
  return open(io, address, gemini::head_port, "send from");
}

std::optional<std::size_t> receive(udp::socket& socket, std::span<std::uint8_t> buffer,
                                   std::uint64_t& overflows) {
  alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(sizeof(std::uint32_t))] = {};
  iovec part{buffer.data(), buffer.size()};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  const ssize_t size = recvmsg(socket.native_handle(), &message, MSG_DONTWAIT);
  if (size < 0) {
    return std::nullopt;
  }
  for (cmsghdr* part_of = CMSG_FIRSTHDR(&message); part_of != nullptr;
       part_of = CMSG_NXTHDR(&message, part_of)) {
    if (part_of->cmsg_level == SOL_SOCKET && part_of->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t total = 0;
      std::memcpy(&total, CMSG_DATA(part_of), sizeof total);
      overflows = total;
    }
  }
  return static_cast<std::size_t>(size);
}

std::uint32_t address_towards(std::uint32_t head) {
  boost::asio::io_context io;
  udp::socket probe(io);
  boost::system::error_code error;
  probe.open(udp::v4(), error);
  if (!error) {
    probe.connect({boost::asio::ip::address_v4(head), gemini::head_port}, error);  // sends nothing
  }
  if (error) {
    throw SocketError(fmt::format("no route to the head at {}: {}", address_text(head), error.message()));
  }
  const std::uint32_t own = probe.local_endpoint().address().to_v4().to_uint();
  return own == head ? INADDR_LOOPBACK : own;
}

std::optional<std::uint32_t> interface_netmask(std::uint32_t address) {
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
