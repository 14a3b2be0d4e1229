// SPDX-License-Identifier: Apache-2.0
// The connection to a head on a serial line: a serial device, or a device server by TCP or UDP.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace sonard::client {

struct LineAddress {
  enum class Way : std::uint8_t { tcp, udp, tty };
  Way way = Way::tcp;
  std::string place;        ///< host, or path of the serial device
  std::uint16_t port = 0;   ///< tcp, udp only
  unsigned baud = 115'200;  ///< tty only

  /// "tcp 127.0.0.1:4001", "tty /dev/ttyUSB0 at 115200 baud".
  std::string text() const;
};

/// One line, which can be reopened after a loss. Everything runs on the thread of the io_context. Events come
/// from its handlers only, never from within a call. Destroy the line only after the io_context has stopped.
class SerialLine {
 public:
  struct Events {
    std::function<void()> opened;
    std::function<void(std::span<const std::uint8_t> bytes)> received;
    /// The line could not be opened, or the other end closed it; it is closed now. Errors of UDP sockets do
    /// not count as a loss, because not every lost datagram causes one.
    std::function<void(const std::string& why)> lost;
  };

  SerialLine(boost::asio::io_context& io, LineAddress address, Events events);

  /// Requires a closed line. A serial device is set to raw mode, 8N1, without flow control; its unread input
  /// is dropped.
  void open();
  bool is_open() const { return descriptor_.is_open(); }
  void close();

  /// Sends a whole frame with one system call and never waits. As on a wire, bytes that a blocked line does
  /// not take are lost. Does nothing if the line is closed.
  void send(std::span<const std::uint8_t> frame);

 private:
  template <class Protocol>
  void connect(typename Protocol::resolver& resolver, typename Protocol::socket& socket);
  void open_tty();
  void adopt(int descriptor);
  void wait_readable();
  void on_readable();
  void lose(const std::string& why);

  LineAddress address_;
  Events events_;
  boost::asio::io_context& io_;
  boost::asio::ip::tcp::resolver tcp_resolver_{io_};
  boost::asio::ip::tcp::socket tcp_socket_{io_};  ///< until connected
  boost::asio::ip::udp::resolver udp_resolver_{io_};
  boost::asio::ip::udp::socket udp_socket_{io_};  ///< until connected
  boost::asio::posix::stream_descriptor descriptor_{io_};
  std::array<std::uint8_t, 4096> buffer_{};
};

}  // namespace sonard::client
