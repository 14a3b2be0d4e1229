// The images of a log, whatever its format: for replay, `sonard info` and whoever looks at them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/micron/messages.hpp"
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

/// A line of a scanning head. Its settings are those of an image of one beam; gain, sound speed and bins
/// those that the line was made with.
struct RecordedScanLine {
  std::int64_t time_ns = 0;  ///< as RecordedImage has it
  RecordedSettings settings;
  double bearing_rad = 0.0;  ///< of the beam: 0 ahead, positive to port
  int bits_per_bin = 8;      ///< 8: bins are 0..255; 4: 0..15
  /// As it travelled, without data; nullopt: the log does not say.
  std::optional<micron::HeadData> wire_line;
  std::size_t place = 0;  ///< of the Recording's own
};

/// A scanning head. Lines are in the order of their times.
struct RecordedScan {
  std::string name;
  std::uint16_t device_id = 0;          ///< its node
  std::vector<RecordedScanLine> lines;  ///< at least one
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
  /// In order of their first lines.
  const std::vector<RecordedScan>& scans() const { return scans_; }
  /// lines * beams samples, line after line from the nearest on, beams from port to starboard.
  /// @throws LogError when they cannot be unpacked
  virtual std::vector<std::uint8_t> pixels(const RecordedImage& image) const = 0;
  /// From near to far, RecordedSettings::lines of them.
  /// @throws LogError when they cannot be unpacked
  virtual std::vector<std::uint8_t> bins(const RecordedScanLine& line) const = 0;
  /// What is wrong with the log, one phrase each: cut, not closed, damaged inside.
  virtual std::vector<std::string> problems() const = 0;
  /// It ends as a log does that was closed.
  virtual bool closed() const = 0;

 protected:
  RecordedHead& head(const std::string& name, std::uint16_t device_id);
  RecordedScan& scan(const std::string& name, std::uint16_t device_id);
  /// To be called once all images and lines are there.
  void sort_by_time();

 private:
  std::vector<RecordedHead> heads_;
  std::vector<RecordedScan> scans_;
};

/// @throws LogError when `file` is broken from its start or holds no images by its kind (.pcapng). Images
/// and lines that make no sense are left out. The recording views `file`, which must outlive it.
std::unique_ptr<Recording> open_recording(const LogFile& file);

}  // namespace sonard::server
