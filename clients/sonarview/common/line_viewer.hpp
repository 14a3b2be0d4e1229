// SPDX-License-Identifier: Apache-2.0
// The loop of a viewer that talks to one head over a line of bytes, whatever the head speaks.
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

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/common/run_options.hpp"
#include "clients/sonarview/common/serial_line.hpp"
#include "protocol/common/ping_job.hpp"

namespace sonard::client {

/// What the summary says of every device.
struct RunCounters {
  std::uint64_t pings = 0;
  double rate_hz = 0.0;  ///< from the first ping to the last
  std::uint64_t reconnects = 0;
  std::uint64_t images_written = 0;
  std::uint64_t images_skipped = 0;
};

/// Opens the line and opens it again when it is lost, says how it goes, ends when a limit is reached or a
/// signal comes, and finishes the pictures. Everything on one thread but the drawing of pictures.
///
/// What a device's viewer knows of the conversation lives as long as the program, whatever becomes of the
/// line: a head goes on when its client is away.
class LineViewer {
 public:
  /// @throws std::runtime_error (folder for pictures)
  explicit LineViewer(const RunOptions& options);
  LineViewer(const LineViewer&) = delete;
  LineViewer& operator=(const LineViewer&) = delete;
  virtual ~LineViewer() = default;

  ExitStatus run();

 protected:
  // ---- What the viewer of a device does. `at` is now.

  /// Asks for pings, and calls open_line() as soon as it is known where the head is.
  virtual void begin(TimePoint at) = 0;
  /// The line is open, the first time or again.
  virtual void on_opened() {}
  virtual void on_bytes(TimePoint at, std::span<const std::uint8_t> bytes) = 0;
  /// Sends what is due; the line is open.
  virtual void talk(TimePoint) {}
  /// When talk() is next needed.
  virtual std::optional<TimePoint> next_deadline() const { return std::nullopt; }
  virtual bool head_met() const = 0;
  /// Takes what has come, with count_ping() for each ping, until stopping().
  virtual void take_received() = 0;
  /// All that was asked for is there, or the head has stopped.
  virtual bool finished() const = 0;
  /// Asks for nothing more. Returns how long the head may take to answer.
  virtual std::chrono::nanoseconds say_goodbye(TimePoint) { return {}; }

  /// Pictures of what there is, for whoever looks at the folder meanwhile; each second.
  virtual void refresh_pictures(ImageWriter& writer) = 0;
  virtual void finish_pictures(ImageWriter& writer) = 0;

  /// The line of each second. @param fresh pings since the last one
  virtual std::string progress_text(std::uint64_t fresh) const = 0;
  /// Why no head was met within `wait_s` though the line is open, or none is known yet.
  virtual std::string no_head_text(double wait_s) const = 0;
  /// Why no ping came within `wait_s`.
  virtual std::string no_ping_text(double wait_s) const = 0;
  /// Prints the summary. Returns whether all is there.
  virtual bool sum_up(const RunCounters& counters) = 0;

  // ---- What it calls

  /// Once.
  void open_line(const LineAddress& address);
  bool line_is_open() const { return line_ && line_->is_open(); }
  void send(std::span<const std::uint8_t> frame) { line_->send(frame); }
  void count_ping(TimePoint received);
  std::uint64_t pings() const { return counters_.pings; }
  void stop();
  bool stopping() const { return stopping_until_.has_value(); }
  /// fail() and stop().
  void give_up(ExitStatus failure, const std::string& message);
  /// Says what went wrong; the program ends with the first such status.
  void fail(ExitStatus failure, const std::string& message);
  TimePoint started() const { return started_; }
  /// Null where no pictures are wanted.
  ImageWriter* writer() { return writer_ ? &*writer_ : nullptr; }
  boost::asio::io_context& io() { return io_; }

 private:
  void line_opened();
  void line_speaks();
  void line_lost(const std::string& why);
  void advance();
  void show_progress(TimePoint at);
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

  const TimePoint started_;
  std::optional<TimePoint> met_at_;
  std::optional<TimePoint> lost_at_ = started_;  ///< nothing: bytes came since
  bool spoke_ = false;                           ///< bytes came, now or once
  std::optional<TimePoint> retry_due_;           ///< nothing: the line is open, or being opened
  std::string trouble_;                          ///< why the line could not be opened last
  TimePoint first_ping_at_{};
  TimePoint last_ping_at_{};
  TimePoint waiting_since_{};  ///< for the next ping
  TimePoint progress_due_{};
  std::uint64_t pings_at_progress_ = 0;
  std::optional<TimePoint> stopping_until_;

  RunCounters counters_;
  std::optional<ImageWriter> writer_;
  std::optional<ExitStatus> failure_;
};

}  // namespace sonard::client
