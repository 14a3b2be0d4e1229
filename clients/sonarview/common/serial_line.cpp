// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/serial_line.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <system_error>
#include <type_traits>
#include <utility>

namespace sonard::client {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::error_code;

std::string reason(int error) {
  return std::generic_category().message(error);
}

/// Sets raw mode, 8N1, no flow control, and drops unread input. Returns 0 or an errno.
int set_up(int tty, unsigned baud) {
  termios settings{};
  if (tcgetattr(tty, &settings) != 0) {
    return errno;
  }
  cfmakeraw(&settings);
  settings.c_cflag |= CREAD | CLOCAL;
  settings.c_cflag &= ~(CSTOPB | CRTSCTS);
  // cfsetspeed() of glibc also accepts plain numbers, and rejects unsupported rates.
  const bool done = cfsetspeed(&settings, baud) == 0 && tcsetattr(tty, TCSANOW, &settings) == 0 &&
                    tcflush(tty, TCIFLUSH) == 0;
  return done ? 0 : errno;
}

}  // namespace

std::string LineAddress::text() const {
  switch (way) {
    case Way::tcp:
      return fmt::format("tcp {}:{}", place, port);
    case Way::udp:
      return fmt::format("udp {}:{}", place, port);
    case Way::tty:
      break;
  }
  return fmt::format("tty {} at {} baud", place, baud);
}

SerialLine::SerialLine(asio::io_context& io, LineAddress address, Events events)
    : address_(std::move(address)), events_(std::move(events)), io_(io) {}

// ---- Opening

void SerialLine::open() {
  switch (address_.way) {
    case LineAddress::Way::tcp:
      connect<tcp>(tcp_resolver_, tcp_socket_);
      return;
    case LineAddress::Way::udp:
      connect<udp>(udp_resolver_, udp_socket_);
      return;
    case LineAddress::Way::tty:
      asio::post(io_, [this] { open_tty(); });
  }
}

template <class Protocol>
void SerialLine::connect(typename Protocol::resolver& resolver, typename Protocol::socket& socket) {
  const auto on_connected = [this, &socket](const error_code& error, const auto&) {
    if (error == asio::error::operation_aborted) {
      return;
    }
    error_code ignored;
    // TCP sometimes connects to itself when it tries an unused port of this machine.
    if (error || socket.local_endpoint(ignored) == socket.remote_endpoint(ignored)) {
      lose((error ? error : error_code(asio::error::connection_refused)).message());
      return;
    }
    // Commands are small, and a head waits for each one.
    if constexpr (std::is_same_v<Protocol, tcp>) {
      socket.set_option(tcp::no_delay(true), ignored);
    }
    adopt(socket.release());
  };
  resolver.async_resolve(
      address_.place, std::to_string(address_.port),
      [this, &socket, on_connected](const error_code& error,
                                    const typename Protocol::resolver::results_type& found) {
        if (error == asio::error::operation_aborted) {
          return;
        }
        if (error) {
          lose(error.message());
          return;
        }
        asio::async_connect(socket, found, on_connected);
      });
}

void SerialLine::open_tty() {
  const int tty = ::open(address_.place.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (tty < 0) {
    lose(reason(errno));
    return;
  }
  if (const int error = set_up(tty, address_.baud); error != 0) {
    ::close(tty);
    lose(error == EINVAL ? fmt::format("it does not support {} baud", address_.baud) : reason(error));
    return;
  }
  adopt(tty);
}

void SerialLine::adopt(int descriptor) {
  error_code error;
  descriptor_.assign(descriptor, error);
  if (!error) {
    descriptor_.non_blocking(true, error);
  }
  if (error) {
    lose(error.message());
    return;
  }
  wait_readable();
  events_.opened();
}

// ---- Talking

void SerialLine::wait_readable() {
  descriptor_.async_wait(asio::posix::stream_descriptor::wait_read, [this](const error_code& error) {
    if (!error && is_open()) {
      on_readable();
    }
  });
}

void SerialLine::on_readable() {
  const bool datagrams = address_.way == LineAddress::Way::udp;
  const ssize_t size = ::read(descriptor_.native_handle(), buffer_.data(), buffer_.size());
  if (size > 0) {
    events_.received(std::span(buffer_).first(static_cast<std::size_t>(size)));
  } else if (size == 0 && !datagrams) {
    lose("closed by the other end");
  } else if (size < 0 && errno != EAGAIN && errno != EINTR && !datagrams) {
    lose(reason(errno));
  }
  if (is_open()) {
    wait_readable();
  }
}

void SerialLine::send(std::span<const std::uint8_t> frame) {
  if (!is_open()) {
    return;
  }
  const int descriptor = descriptor_.native_handle();
  [[maybe_unused]] const ssize_t taken =  // lost frames are requested again
      address_.way == LineAddress::Way::tty ? ::write(descriptor, frame.data(), frame.size())
                                            : ::send(descriptor, frame.data(), frame.size(), MSG_NOSIGNAL);
}

// ---- Closing

void SerialLine::close() {
  error_code ignored;
  tcp_resolver_.cancel();
  udp_resolver_.cancel();
  tcp_socket_.close(ignored);
  udp_socket_.close(ignored);
  descriptor_.close(ignored);
}

void SerialLine::lose(const std::string& why) {
  close();
  events_.lost(why);
}

}  // namespace sonard::client
