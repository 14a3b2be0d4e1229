// SPDX-License-Identifier: Apache-2.0
// A serial line as a pseudo terminal, for clients that open a tty.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "server/net/serial_port.hpp"
#include "server/net/udp_endpoint.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// The link to a pseudo terminal cannot be made. To try again is of no use: the configuration or the folder
/// must change.
struct PtyLinkError : SocketError {
  using SocketError::SocketError;
  std::size_t item = 0;  ///< place in SerialLinkConfig::pty
};

/// The slave is in raw mode, without echo, each time a client finds it closed; settings of the last client
/// are undone, and its unread data is dropped. Several clients may open it at a time: as on a real tty, each
/// byte then goes to one of them, and they count as gone when the last one closes it.
///
/// The kernel reports when the slave is closed, but not when it is opened. So while it is closed, it is
/// polled every `look_again`. Until the port notices a client, the client receives nothing, but its data is
/// not lost. A client that opens the slave between another's close and its detection continues that client's
/// session.
///
/// The constructor makes the link, and stop() removes it unless it has been replaced. An existing link to a
/// slave counts as left by a crash and is replaced. Any other existing file is not.
class PtyPort final : public SerialPort {
 public:
  static constexpr std::chrono::milliseconds look_again{20};

  /// @throws SocketError, PtyLinkError
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
