// SPDX-License-Identifier: Apache-2.0
// The main loop of a viewer with one head on a byte stream, for any protocol.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/common/head_run.hpp"
#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/common/run_options.hpp"
#include "clients/sonarview/common/serial_line.hpp"
#include "protocol/common/ping_job.hpp"

namespace sonard::client {

/// Why bytes arrive but no ping: "120 bytes arrived that are not of an Example 100 (...)".
/// @param head with its article: "an Example 100"
std::string foreign_bytes_text(std::uint64_t bytes, std::string_view head);

/// Opens the line, reopens a lost line, prints progress, and finishes the pictures. It ends at a limit or a
/// signal. All runs on one thread, except that pictures are drawn on the writer's thread.
///
/// The state of a device's viewer survives the loss of the line, because a head continues without its client.
class LineViewer {
 public:
  /// @throws std::runtime_error (folder for pictures)
  explicit LineViewer(const RunOptions& options) : options_(options), run_(options, options.out) {}
  LineViewer(const LineViewer&) = delete;
  LineViewer& operator=(const LineViewer&) = delete;
  virtual ~LineViewer() = default;

  ExitStatus run();

 protected:
  // ---- Implemented by the viewer of a device. `at` is the present time.

  /// Requests pings, and calls open_line() as soon as the head's address is known.
  virtual void begin(TimePoint at) = 0;
  /// The line was opened, for the first time or again.
  virtual void on_opened() {}
  virtual void on_bytes(TimePoint at, std::span<const std::uint8_t> bytes) = 0;
  /// Sends the bytes that are due; the line is open.
  virtual void talk(TimePoint) {}
  /// When to call talk() next; nullopt: nothing is due.
  virtual std::optional<TimePoint> next_deadline() const { return std::nullopt; }
  virtual bool head_met() const = 0;
  /// Handles all received pings, with count_ping() for each, until stopping().
  virtual void take_received() = 0;
  /// Whether everything requested has arrived, or the head has stopped.
  virtual bool finished() const = 0;
  /// Requests no more pings. Returns how long to wait for the head's last answers.
  virtual std::chrono::nanoseconds say_goodbye(TimePoint) { return {}; }

  /// Draws the data received so far; called each second.
  virtual void refresh_pictures(ImageWriter& writer) = 0;
  virtual void finish_pictures(ImageWriter& writer) = 0;

  /// The progress line of each second. @param fresh pings since the previous line
  virtual std::string progress_text(std::uint64_t fresh) const = 0;
  /// What the viewer waits for after begin(): "head 2 on tcp 127.0.0.1:4001".
  virtual std::string awaited_text() const = 0;
  /// Why no head was found within `wait_s`, if the line is open or no address is known yet.
  virtual std::string no_head_text(double wait_s) const = 0;
  /// Advice if the line cannot be opened: "; ..." or "".
  virtual std::string not_open_advice() const { return {}; }
  /// Why no ping arrived within `wait_s`.
  virtual std::string no_ping_text(double wait_s) const = 0;
  /// Prints the summary. Returns whether all requested data arrived.
  virtual bool sum_up(const RunCounters& counters) = 0;

  // ---- Called by the viewer of a device

  /// Handles all that has arrived, also in another way than by the line.
  void advance();
  /// Call once.
  void open_line(const LineAddress& address);
  bool line_is_open() const { return line_ && line_->is_open(); }
  void send(std::span<const std::uint8_t> frame) { line_->send(frame); }
  void count_ping(TimePoint received) { run_.count_ping(received); }
  std::uint64_t pings() const { return run_.counters().pings; }
  void stop();
  bool stopping() const { return stopping_until_.has_value(); }
  /// Calls fail() and stop().
  void give_up(ExitStatus failure, const std::string& message);
  /// As in HeadRun.
  void fail(ExitStatus failure, const std::string& message) { run_.fail(failure, message); }
  void say(const std::string& message) const { run_.say(message); }
  ImageWriter* writer() { return run_.writer(); }
  TimePoint started() const { return run_.started(); }
  boost::asio::io_context& io() { return io_; }

 private:
  void line_opened();
  void line_speaks();
  void line_lost(const std::string& why);
  /// False if a line exists but is lost.
  bool listens() const { return !line_ || line_is_open(); }
  void check_limits(TimePoint at);
  void end();
  void arm_timer();
  ExitStatus end_status();

  const RunOptions options_;
  boost::asio::io_context io_;
  std::optional<SerialLine> line_;
  std::string line_text_;  ///< LineAddress::text()
  boost::asio::steady_timer timer_{io_};
  boost::asio::signal_set signals_{io_, SIGINT, SIGTERM};

  HeadRun run_;
  std::optional<TimePoint> lost_at_;    ///< nullopt: no line yet, or bytes have arrived since the last loss
  bool spoke_ = false;                  ///< whether bytes ever arrived
  std::optional<TimePoint> retry_due_;  ///< nullopt: the line is open, or being opened
  std::string trouble_;                 ///< why the line was lost, or could not be opened
  std::optional<TimePoint> stopping_until_;
};

}  // namespace sonard::client
