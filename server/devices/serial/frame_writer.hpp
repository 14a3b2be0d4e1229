// Whole frames into a stream whose other end may be slow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/system/error_code.hpp>

namespace sonard::server {

/// Stream is a non-blocking tcp::socket or posix::stream_descriptor that outlives the writer. Errors of the
/// stream are left to whoever reads from it: they end the session there.
template <typename Stream>
class FrameWriter {
 public:
  explicit FrameWriter(Stream& stream) : stream_(stream) {}

  /// One write. When the stream takes only a part, the rest is kept until it takes that too.
  /// @param owner of this writer and the stream, kept alive until then
  /// @return false when the frame was dropped
  bool send(std::span<const std::uint8_t> frame, const std::shared_ptr<void>& owner) {
    if (!rest_.empty()) {
      return false;
    }
    const std::size_t written = write(frame);
    if (written == 0) {
      return false;
    }
    rest_.assign(frame.begin() + static_cast<std::ptrdiff_t>(written), frame.end());
    wait_for_room(owner);
    return true;
  }

  /// Forgets the rest of a frame whose reader is gone.
  void clear() { rest_.clear(); }

 private:
  std::size_t write(std::span<const std::uint8_t> bytes) {
    boost::system::error_code ignored;
    return stream_.write_some(boost::asio::buffer(bytes.data(), bytes.size()), ignored);
  }

  void wait_for_room(const std::shared_ptr<void>& owner) {
    if (rest_.empty() || waiting_) {
      return;
    }
    waiting_ = true;
    stream_.async_wait(Stream::wait_write, [this, owner](const boost::system::error_code& error) {
      waiting_ = false;
      if (!error) {
        const std::size_t written = write(rest_);
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
