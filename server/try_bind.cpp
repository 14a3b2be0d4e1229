// SPDX-License-Identifier: Apache-2.0
#include "server/try_bind.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <type_traits>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>

#include "server/net/addresses.hpp"
#include "server/net/udp_endpoint.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;

template <typename Protocol>
boost::system::error_code bind_error(const Endpoint& endpoint) {
  asio::io_context io;
  typename Protocol::socket socket(io);
  boost::system::error_code error;
  socket.open(Protocol::v4(), error);
  if constexpr (std::is_same_v<Protocol, asio::ip::tcp>) {
    // As for the listener: lingering connections of an earlier run are no obstacle.
    if (!error) {
      socket.set_option(asio::socket_base::reuse_address(true), error);
    }
  }
  if (!error) {
    socket.bind({asio::ip::address_v4(endpoint.address), endpoint.port}, error);
  }
  if constexpr (std::is_same_v<Protocol, asio::ip::tcp>) {
    if (!error) {
      asio::ip::tcp::acceptor(io, Protocol::v4(), socket.release()).listen(1, error);
    }
  }
  return error;
}

}  // namespace

std::optional<std::string> obstacle_to_binding(const PlannedSocket& planned) {
  const bool udp = planned.transport == PlannedSocket::Transport::udp;
  const Endpoint& endpoint = planned.endpoint;
  const boost::system::error_code error =
      udp ? bind_error<asio::ip::udp>(endpoint) : bind_error<asio::ip::tcp>(endpoint);
  if (!error) {
    return std::nullopt;
  }
  const char* const transport = udp ? "UDP" : "TCP";
  if (error == asio::error::address_in_use) {
    return fmt::format("{} {} is in use by another program (expected a free port)", transport,
                       endpoint_text(endpoint));
  }
  if (error.value() == EADDRNOTAVAIL) {
    return fmt::format(
        "{} is not an address of this machine (expected an address of an interface here; if "
        "another network namespace has it, use --no-network)",
        address_text(endpoint.address));
  }
  return fmt::format("{} {} cannot be bound: {} (expected an address and port to listen on)", transport,
                     endpoint_text(endpoint), error.message());
}

std::vector<PlannedSocket> own_sockets() {
  std::vector<PlannedSocket> own;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", ignored)) {
    const int fd = std::atoi(entry.path().filename().c_str());
    int type = 0, listens = 0;
    socklen_t size = sizeof type;
    sockaddr_in bound{};
    socklen_t bound_size = sizeof bound;
    if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) != 0 ||
        getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &bound_size) != 0 ||
        bound.sin_family != AF_INET) {
      continue;
    }
    size = sizeof listens;
    const bool udp = type == SOCK_DGRAM;
    if (udp || (getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) == 0 && listens != 0)) {
      own.push_back({udp ? PlannedSocket::Transport::udp : PlannedSocket::Transport::tcp,
                     {ntohl(bound.sin_addr.s_addr), ntohs(bound.sin_port)},
                     ""});
    }
  }
  return own;
}

}  // namespace sonard::server
