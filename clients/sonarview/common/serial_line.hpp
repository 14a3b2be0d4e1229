// SPDX-License-Identifier: Apache-2.0
// The way of bytes to a head on a serial line: a serial device, or a device server by TCP or UDP.
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
  std::string place;        ///< host, or path of the device
  std::uint16_t port = 0;   ///< tcp, udp
  unsigned baud = 115'200;  ///< tty

  /// "tcp 127.0.0.1:4001", "tty /dev/ttyUSB0 at 115200 baud".
  std::string text() const;
};

/// One line, which may be opened again after it was lost. Everything happens on the thread that runs the
/// io_context; events come from its handlers only, never from within a call. The line outlives them: destroy
/// it when the io_context has stopped.
class SerialLine {
 public:
  struct Events {
    std::function<void()> opened;
    std::function<void(std::span<const std::uint8_t> bytes)> received;
    /// It could not be opened, or the other end is gone; it is closed now. A datagram that no one received is
    /// no reason: that UDP tells of it is chance.
    std::function<void(const std::string& why)> lost;
  };

  SerialLine(boost::asio::io_context& io, LineAddress address, Events events);

  /// Requires that it is closed. A serial device is put into raw mode, 8N1, without flow control; what waited
  /// to be read is dropped.
  void open();
  bool is_open() const { return descriptor_.is_open(); }
  void close();

  /// A whole frame with one system call, now or never: what a line that is stuck does not take is dropped, as
  /// on a wire. Nothing while it is closed.
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
  boost::asio::ip::tcp::socket tcp_socket_{io_};  ///< while it connects
  boost::asio::ip::udp::resolver udp_resolver_{io_};
  boost::asio::ip::udp::socket udp_socket_{io_};  ///< while it connects
  boost::asio::posix::stream_descriptor descriptor_{io_};
  std::array<std::uint8_t, 4096> buffer_{};
};

}  // namespace sonard::client
