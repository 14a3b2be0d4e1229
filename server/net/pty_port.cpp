// SPDX-License-Identifier: Apache-2.0
#include "server/net/pty_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/net/frame_writer.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/program_log/peer_log.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;
using asio::posix::stream_descriptor;
using boost::system::error_code;

constexpr std::string_view slave_folder = "/dev/pts/";

int open_master() {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (master < 0) {
    throw_socket_error("open a pseudo terminal", errno);
  }
  return master;
}

std::string unlock_slave(int master) {
  std::array<char, 64> path{};
  if (grantpt(master) != 0 || unlockpt(master) != 0 || ptsname_r(master, path.data(), path.size()) != 0) {
    throw_socket_error("unlock a pseudo terminal", errno);
  }
  return path.data();
}

/// Sets raw mode without echo, and drops unread input. Data that clients have written stays.
void reset_slave(const std::string& path) {
  const int slave = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (slave < 0) {
    throw_socket_error("open " + path, errno);
  }
  termios settings{};
  const bool done = tcgetattr(slave, &settings) == 0 &&
                    (cfmakeraw(&settings), cfsetspeed(&settings, B115200)) == 0 &&
                    tcsetattr(slave, TCSANOW, &settings) == 0 && tcflush(slave, TCIFLUSH) == 0;
  const int error = errno;
  ::close(slave);
  if (!done) {
    throw_socket_error("set up " + path, error);
  }
}

/// Target of a symbolic link if it is a slave, else empty.
std::string linked_slave(const fs::path& link) {
  std::error_code error;
  const std::string target = fs::read_symlink(link, error);  // fails if it is not a link
  return !error && target.starts_with(slave_folder) ? target : std::string();
}

void make_link(const fs::path& link, const std::string& target) {
  std::error_code error;
  fs::create_symlink(target, link, error);
  if (error == std::errc::file_exists) {
    const std::string before = linked_slave(link);
    if (before.empty()) {
      throw PtyLinkError(
          fmt::format("cannot create the link {}: the path exists and is not a link to a pseudo terminal, so "
                      "sonard does not replace it",
                      link.string()));
    }
    spdlog::info("serial pty: {} now leads to {} (before: {})", link.string(), target, before);
    fs::remove(link, error);
    fs::create_symlink(target, link, error);
  }
  if (error) {
    throw PtyLinkError(
        fmt::format("cannot create the link {} to {}: {}", link.string(), target, error.message()));
  }
}

}  // namespace

struct PtyPort::Impl : std::enable_shared_from_this<PtyPort::Impl> {
  Impl(asio::io_context& io, SerialPtyConfig port_config)
      : config(std::move(port_config)), master(io, open_master()), writer(master), look_timer(io) {}

  void open();
  void check_client();
  void wait_readable();
  void on_readable();
  void leave();
  void stop();
  std::string description() const;
  WireEnds ends() const { return {WireTransport::pty, {}, {}, path}; }

  SerialPtyConfig config;
  stream_descriptor master;
  FrameWriter<stream_descriptor> writer;
  asio::steady_timer look_timer;
  std::string path;
  SerialPortEvents events;
  bool occupied = false;
  std::array<std::uint8_t, serial_read_bytes> buffer{};
  SerialPortCounters counters;
  PeerLog log;
};

void PtyPort::Impl::open() {
  error_code error;
  master.non_blocking(true, error);
  path = unlock_slave(master.native_handle());
  reset_slave(path);  // only a slave that was opened once counts as closed
  if (!config.link.empty()) {
    make_link(config.link, path);
  }
}

/// Polls until a client opens the slave.
void PtyPort::Impl::check_client() {
  pollfd state{master.native_handle(), POLLIN, 0};
  poll(&state, 1, /*timeout=*/0);
  // A client that wrote and closed since the last check counts too.
  if ((state.revents & POLLHUP) == 0 || (state.revents & POLLIN) != 0) {
    occupied = true;
    ++counters.connections;
    log.info("serial {}: opened", description());
    wait_readable();
    return;
  }
  look_timer.expires_after(look_again);
  look_timer.async_wait([self = shared_from_this()](const error_code& error) {
    if (!error && self->master.is_open()) {
      self->check_client();
    }
  });
}

void PtyPort::Impl::wait_readable() {
  master.async_wait(stream_descriptor::wait_read, [self = shared_from_this()](const error_code& error) {
    if (!error && self->master.is_open()) {
      self->on_readable();
    }
  });
}

void PtyPort::Impl::on_readable() {
  error_code error;
  const std::size_t length = master.read_some(asio::buffer(buffer), error);
  if (error && error != asio::error::would_block) {  // EIO: the slave is closed, and all its data is read
    leave();
    return;
  }
  if (length > 0 && events.takes(0)) {
    counters.bytes_in += length;
    if (events.passed) {
      events.passed(ends(), /*to_client=*/false, {buffer.data(), length});
    }
    events.received({buffer.data(), length}, "pty " + path);
  }
  if (master.is_open()) {
    wait_readable();
  }
}

void PtyPort::Impl::leave() {
  occupied = false;
  writer.clear();
  log.info("serial {}: closed", description());
  try {
    reset_slave(path);
  } catch (const std::runtime_error& error) {  // the next client may read data that this one did not
    log.warn("serial {}: {}", description(), error.what());
  }
  if (events.ended) {
    events.ended(ends());
  }
  events.left("pty " + path);
  if (master.is_open()) {
    check_client();
  }
}

void PtyPort::Impl::stop() {
  if (!master.is_open()) {
    return;
  }
  occupied = false;
  writer.clear();
  look_timer.cancel();
  if (!config.link.empty() && linked_slave(config.link) == path) {
    std::error_code ignored;
    fs::remove(config.link, ignored);
  }
  error_code ignored;
  master.close(ignored);
}

std::string PtyPort::Impl::description() const {
  return config.link.empty() ? "pty " + path
                             : fmt::format("pty {} linked to by {}", path, config.link.string());
}

PtyPort::PtyPort(asio::io_context& io, const SerialPtyConfig& config)
    : impl_(std::make_shared<Impl>(io, config)) {
  impl_->open();
}

PtyPort::~PtyPort() {
  impl_->stop();
}

void PtyPort::start(SerialPortEvents events) {
  impl_->events = std::move(events);
  impl_->check_client();
}

void PtyPort::stop() {
  impl_->stop();
}

void PtyPort::send(std::span<const std::uint8_t> frame) {
  if (!impl_->occupied) {
    return;
  }
  const FrameFate fate = impl_->writer.send(frame, impl_);
  if (count_frame(fate, frame.size(), impl_->counters) && impl_->events.passed) {
    impl_->events.passed(impl_->ends(), /*to_client=*/true, frame);
  }
}

bool PtyPort::connected() const {
  return impl_->occupied;
}

std::string PtyPort::description() const {
  return impl_->description();
}

SerialPortCounters PtyPort::counters() const {
  return impl_->counters;
}

const std::string& PtyPort::path() const {
  return impl_->path;
}

}  // namespace sonard::server
