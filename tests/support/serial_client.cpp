// SPDX-License-Identifier: Apache-2.0
#include "tests/support/serial_client.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include <gtest/gtest.h>

namespace sonard::test {
namespace {

int checked(int result, const char* what) {
  if (result < 0) {
    throw std::system_error(errno, std::generic_category(), what);
  }
  return result;
}

sockaddr_in to_sockaddr(const Endpoint& endpoint) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  address.sin_addr.s_addr = htonl(endpoint.address);
  return address;
}

Client connected(int type, const Endpoint& to, Ipv4 from, int receive_buffer_bytes) {
  Client client(checked(socket(AF_INET, type | SOCK_CLOEXEC, 0), "socket"));
  if (receive_buffer_bytes > 0) {
    checked(
        setsockopt(client.fd(), SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof receive_buffer_bytes),
        "SO_RCVBUF");
  }
  const sockaddr_in local = to_sockaddr({from, 0});
  const sockaddr_in remote = to_sockaddr(to);
  checked(bind(client.fd(), reinterpret_cast<const sockaddr*>(&local), sizeof local), "bind");
  checked(connect(client.fd(), reinterpret_cast<const sockaddr*>(&remote), sizeof remote), "connect");
  checked(fcntl(client.fd(), F_SETFL, O_NONBLOCK), "O_NONBLOCK");
  return client;
}

}  // namespace

Client Client::tcp(const Endpoint& to, Ipv4 from, int receive_buffer_bytes) {
  return connected(SOCK_STREAM, to, from, receive_buffer_bytes);
}

Client Client::udp(const Endpoint& to, Ipv4 from) {
  return connected(SOCK_DGRAM, to, from, 0);
}

Client Client::tty(const std::string& path) {
  return Client(checked(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC), "open"));
}

bool Client::try_write(std::span<const std::uint8_t> bytes) const {
  // A socket closed by the link must fail the test, not kill it with SIGPIPE.
  ssize_t written = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (written < 0 && errno == ENOTSOCK) {
    written = ::write(fd_, bytes.data(), bytes.size());
  }
  return written == static_cast<ssize_t>(bytes.size());
}

void Client::write(std::span<const std::uint8_t> bytes) const {
  EXPECT_TRUE(try_write(bytes)) << std::generic_category().message(errno);
}

Bytes Client::read_once() const {
  Bytes bytes(4096);
  const ssize_t length = ::read(fd_, bytes.data(), bytes.size());
  bytes.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
  return bytes;
}

const Bytes& Client::heard() {
  for (Bytes bytes = read_once(); !bytes.empty(); bytes = read_once()) {
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  }
  return heard_;
}

bool Client::closed_by_peer() {
  heard();
  std::uint8_t byte = 0;
  const ssize_t length = ::read(fd_, &byte, 1);
  return length == 0 || (length < 0 && errno != EAGAIN);
}

std::size_t Client::readable() const {
  int count = 0;
  checked(ioctl(fd_, FIONREAD, &count), "FIONREAD");
  return static_cast<std::size_t>(count);
}

Endpoint Client::endpoint() const {
  sockaddr_in address{};
  socklen_t length = sizeof address;
  checked(getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &length), "getsockname");
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

void Client::close() {
  if (fd_ >= 0) {
    ::close(fd_);
    fd_ = -1;
  }
}

void Client::reset() {
  const linger at_once{1, 0};
  checked(setsockopt(fd_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once), "SO_LINGER");
  close();
}

}  // namespace sonard::test
