// SPDX-License-Identifier: Apache-2.0
// Writes whole frames to a stream whose reader may be slow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/system/error_code.hpp>

#include "server/net/serial_port.hpp"

namespace sonard::server {

enum class FrameFate : std::uint8_t {
  sent,
  no_room,    ///< dropped: the reader has not read earlier data
  no_reader,  ///< dropped: the other end is gone
};

/// @return true if it was sent
inline bool count_frame(FrameFate fate, std::size_t bytes, SerialPortCounters& counters) {
  counters.bytes_out += fate == FrameFate::sent ? bytes : 0;
  counters.frames_dropped += fate == FrameFate::no_room ? 1 : 0;
  counters.frames_lost += fate == FrameFate::no_reader ? 1 : 0;
  return fate == FrameFate::sent;
}

/// Stream is a non-blocking tcp::socket or posix::stream_descriptor that outlives the writer. Errors are left
/// to the reader of the stream, which ends the session.
template <typename Stream>
class FrameWriter {
 public:
  explicit FrameWriter(Stream& stream) : stream_(stream) {}

  /// Writes once. If the stream takes only a part, the rest is kept and written later.
  /// @param owner of this writer and the stream, kept alive until the rest is written
  FrameFate send(std::span<const std::uint8_t> frame, const std::shared_ptr<void>& owner) {
    if (!rest_.empty()) {
      return FrameFate::no_room;
    }
    boost::system::error_code error;
    const std::size_t written = write(frame, error);
    if (written == 0) {
      return error == boost::system::errc::operation_would_block ? FrameFate::no_room : FrameFate::no_reader;
    }
    rest_.assign(frame.begin() + static_cast<std::ptrdiff_t>(written), frame.end());
    wait_for_room(owner);
    return FrameFate::sent;
  }

  /// Drops the rest of a frame whose reader is gone.
  void clear() { rest_.clear(); }

 private:
  std::size_t write(std::span<const std::uint8_t> bytes, boost::system::error_code& error) {
    return stream_.write_some(boost::asio::buffer(bytes.data(), bytes.size()), error);
  }

  void wait_for_room(const std::shared_ptr<void>& owner) {
    if (rest_.empty() || waiting_) {
      return;
    }
    waiting_ = true;
    stream_.async_wait(Stream::wait_write, [this, owner](const boost::system::error_code& error) {
      waiting_ = false;
      if (!error) {
        boost::system::error_code ignored;
        const std::size_t written = write(rest_, ignored);
        rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(written));
        wait_for_room(owner);
      }
    });
  }

  Stream& stream_;
  std::vector<std::uint8_t> rest_;  // of the last frame
  bool waiting_ = false;
};

}  // namespace sonard::server
