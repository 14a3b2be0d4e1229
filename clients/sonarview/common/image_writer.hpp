// SPDX-License-Identifier: Apache-2.0
// Pictures, drawn and written beside the conversation with the head.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <string>
#include <thread>
#include <vector>

namespace sonard::client {

struct Picture {
  std::string file;               ///< in the folder of the writer, "fan-last.png"
  std::function<cv::Mat()> draw;  ///< called on the writer's thread, once
};

/// Encoding a picture takes longer than a head waits for an answer, so it has a thread of its own. Pictures
/// wait for it in a bounded queue; when that is full, the oldest are not drawn, and counted. A file takes its
/// name when it is whole, so that whoever opens a picture while it is replaced sees the old one or the new
/// one.
class ImageWriter {
 public:
  /// Makes the folder.
  /// @throws std::runtime_error naming it
  explicit ImageWriter(std::filesystem::path folder);
  /// Writes what is waiting first.
  ~ImageWriter();

  /// All pictures of one ping, or of one turn. They are drawn in this order.
  void write(std::vector<Picture> pictures);

  /// The state of things until more is known: drawn when nothing else waits, unless a newer call of refresh()
  /// or write() comes before. Neither written() nor skipped() counts it.
  void refresh(std::vector<Picture> pictures);

  /// Waits until everything is written. Nothing may be written after it.
  void finish();
  std::uint64_t written() const { return written_; }  ///< pictures of write(); after finish()
  std::uint64_t skipped() const { return skipped_; }  ///< calls of write() without effect; after finish()
  /// First trouble with a file; empty if there was none. After finish().
  const std::string& error() const { return error_; }

 private:
  void run();
  /// Whether it is there now, under its name.
  bool save(const Picture& picture);

  std::filesystem::path folder_;
  std::uint64_t written_ = 0;  ///< writer's thread, read after finish()
  std::string error_;          ///< see error()

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::vector<Picture>> queue_;  ///< guarded by mutex_
  std::vector<Picture> fresh_;              ///< of refresh(), guarded by mutex_; empty: none waits
  std::uint64_t skipped_ = 0;               ///< guarded by mutex_
  bool finishing_ = false;                  ///< guarded by mutex_
  std::thread thread_;                      ///< last member: starts when all others are there
};

}  // namespace sonard::client
