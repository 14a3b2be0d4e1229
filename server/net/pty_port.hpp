// SPDX-License-Identifier: Apache-2.0
// A serial line as a pseudo terminal, for clients that open a tty.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "server/net/serial_port.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// The slave is in raw mode, without echo, each time a client finds it closed, whatever the one before had
/// set; what that one left unread is gone. Clients may open it several at a time; as on a real tty each byte
/// then goes to one of them, and they have left when the last has closed it.
///
/// The kernel tells when the slave is closed, but not when it is opened: that is looked for every
/// `look_again` while nobody is there, and until it is noticed a client gets nothing. What it has written by
/// then is not lost. Likewise, a client that opens the slave in the moment between another's close and its
/// being noticed goes on where that one was.
///
/// The link is made in the constructor and removed by stop(), unless something else stands there by then. A
/// link to a slave that is already there is taken for one left behind by a crash, and replaced; anything else
/// is not.
class PtyPort final : public SerialPort {
 public:
  static constexpr std::chrono::milliseconds look_again{20};

  /// @throws SocketError
  PtyPort(boost::asio::io_context& io, const SerialPtyConfig& config);
  ~PtyPort() override;

  void start(SerialPortEvents events) override;
  void stop() override;
  void send(std::span<const std::uint8_t> frame) override;
  bool connected() const override;
  /// "pty /dev/pts/3", or "pty /dev/pts/3 linked to by /tmp/sonar".
  std::string description() const override;
  SerialPortCounters counters() const override;

  /// Path of the slave.
  const std::string& path() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
