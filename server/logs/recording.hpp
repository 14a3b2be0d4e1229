// The images of a log, whatever its format: for replay, `sonard info` and whoever looks at them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/logs/log_file.hpp"

namespace sonard::server {

/// What a ping was made with, as far as logs say.
struct RecordedSettings {
  int lines = 0;
  int beams = 0;
  double line_step_m = 0.0;  ///< line i holds [i, i + 1) of it
  double sound_speed_mps = 0.0;
  bool sound_speed_from_config = true;  ///< a client had set it; false: the head measured it
  double gain_percent = -1.0;           ///< 0..100; below 0: the log does not say
  double frequency_hz = 0.0;            ///< of the sound; 0: the log does not say

  double range_m() const { return lines * line_step_m; }
  bool operator==(const RecordedSettings&) const = default;
};

/// Within 146 years of 1970, so that differences of times cannot overflow.
constexpr bool plausible_time(std::int64_t time_ns) {
  constexpr std::int64_t limit_ns = std::int64_t{1} << 62;
  return time_ns > -limit_ns && time_ns < limit_ns;
}

struct RecordedImage {
  /// Since the Unix epoch. A .glf has local time and does not say which zone: there it counts as if that were
  /// UTC.
  std::int64_t time_ns = 0;
  RecordedSettings settings;
  std::size_t place = 0;  ///< of the Recording's own
};

/// A multibeam head. Images are in the order of their times.
struct RecordedHead {
  std::string name;  ///< empty where the log has none
  std::uint16_t device_id = 0;
  std::vector<RecordedImage> images;  ///< at least one
  /// Of the first image: one for each beam in the order of pixels, positive to port.
  std::vector<double> bearings_rad;
};

/// Reads on demand from the mapped file; any thread.
class Recording {
 public:
  Recording() = default;
  virtual ~Recording() = default;
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// In order of their first images.
  const std::vector<RecordedHead>& heads() const { return heads_; }
  /// lines * beams samples, line after line from the nearest on, beams from port to starboard.
  /// @throws LogError when they cannot be unpacked
  virtual std::vector<std::uint8_t> pixels(const RecordedImage& image) const = 0;
  /// What is wrong with the log, one phrase each: cut, not closed, damaged inside.
  virtual std::vector<std::string> problems() const = 0;
  /// It ends as a log does that was closed.
  virtual bool closed() const = 0;

 protected:
  RecordedHead& head(const std::string& name, std::uint16_t device_id);
  /// To be called once all images are there.
  void sort_images();

 private:
  std::vector<RecordedHead> heads_;
};

/// @throws LogError when `file` is broken from its start or holds no images by its kind (.pcapng). Images
/// that make no sense are left out. The recording views `file`, which must outlive it.
std::unique_ptr<Recording> open_recording(const LogFile& file);

}  // namespace sonard::server
