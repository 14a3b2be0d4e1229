// Pictures of pings, written beside the conversation with the head.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "clients/sonarview/fan_image.hpp"
#include "protocol/gemini/surface.hpp"

namespace sonard::client {

/// Encoding a picture takes longer than a head waits for a retry request, so it has a thread of its own.
/// Pings wait for it in a bounded queue; when that is full, the oldest goes without a picture and is counted.
class ImageWriter {
 public:
  struct Settings {
    std::filesystem::path folder;
    FanLook look;
    double sound_speed_mps = 1500.0;  ///< in which the user counts ranges
  };

  /// Makes the folder.
  /// @throws std::runtime_error naming it
  explicit ImageWriter(Settings settings);
  /// Writes what is waiting first.
  ~ImageWriter();

  /// `name`: the files will be fan-<name>.png and polar-<name>.png.
  void write(gemini::ReceivedPing ping, std::string name);

  /// Waits until everything is written. Nothing may be written after it.
  void finish();
  std::uint64_t written() const { return written_; }  ///< after finish()
  std::uint64_t skipped() const { return skipped_; }  ///< after finish()
  /// First trouble with a file; empty if there was none. After finish().
  const std::string& error() const { return error_; }

 private:
  struct Waiting {
    gemini::ReceivedPing ping;
    std::string name;
  };

  void run();
  void draw(const Waiting& waiting);
  void save(const std::string& file, const cv::Mat& image);

  Settings settings_;
  std::optional<FanImage> fan_;  ///< for the shape of the last ping
  std::uint64_t written_ = 0;    ///< writer's thread, read after finish()
  std::string error_;            ///< as above

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Waiting> queue_;  ///< guarded by mutex_
  std::uint64_t skipped_ = 0;  ///< guarded by mutex_
  bool finishing_ = false;     ///< guarded by mutex_
  std::thread thread_;         ///< last member: starts when all others are there
};

}  // namespace sonard::client
