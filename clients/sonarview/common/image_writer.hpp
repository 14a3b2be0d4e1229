// SPDX-License-Identifier: Apache-2.0
// Draws and writes pictures on a thread of their own.
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
  std::string file;               ///< name in the writer's folder, "fan-last.png"
  std::function<cv::Mat()> draw;  ///< called once, on the writer's thread
};

/// Draws and writes pictures on its own thread, because encoding takes longer than a head waits for an
/// answer. Pictures wait in a bounded queue. If it is full, the oldest are dropped and counted. A file gets
/// its name when it is complete, so a reader sees the old or the new picture, never a part.
class ImageWriter {
 public:
  /// Creates the folder.
  /// @throws std::runtime_error that names the folder
  explicit ImageWriter(std::filesystem::path folder);
  /// Writes the waiting pictures first.
  ~ImageWriter();

  /// Queues all pictures of one ping or sweep. They are drawn in this order.
  void write(std::vector<Picture> pictures);

  /// Replaces the pictures of an unfinished ping or sweep. They are drawn when the queue is empty, unless
  /// refresh() or write() is called again first. written() and skipped() do not count them.
  void refresh(std::vector<Picture> pictures);

  /// Waits until all pictures are written. Do not call write() or refresh() afterwards.
  void finish();
  std::uint64_t written() const { return written_; }  ///< pictures of write(); valid after finish()
  std::uint64_t skipped() const { return skipped_; }  ///< dropped calls of write(); valid after finish()
  /// The first file that failed; empty if all files were written. Valid after finish().
  const std::string& error() const { return error_; }

 private:
  void run();
  /// Returns whether the file is complete under its name.
  bool save(const Picture& picture);

  std::filesystem::path folder_;
  std::uint64_t written_ = 0;  ///< written by the writer's thread, read after finish()
  std::string error_;          ///< used like written_

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::vector<Picture>> queue_;  ///< guarded by mutex_
  std::vector<Picture> fresh_;              ///< of refresh(), guarded by mutex_; empty: nothing to draw
  std::uint64_t skipped_ = 0;               ///< guarded by mutex_
  bool finishing_ = false;                  ///< guarded by mutex_
  std::thread thread_;                      ///< last member: starts when the others are initialised
};

}  // namespace sonard::client
