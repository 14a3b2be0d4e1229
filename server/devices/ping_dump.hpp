// SPDX-License-Identifier: Apache-2.0
// Writes rendered pings to files, so that a test can compare them with received ones.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "server/rendering/posed_ping.hpp"

namespace sonard::server {

/// CRC-32 (zlib's polynomial) of the samples in wire order, before any run-length coding: line after line,
/// port to starboard; 16-bit samples most significant byte first. Ranges and intensities of directions as in
/// their file.
std::uint32_t samples_crc32(const render::PingSamples& samples);

/// Writes each ping of one head as a NumPy file, <head>-<ping number, 8 digits>.npy, shape (lines, beams),
/// dtype |u1 or <u2, and adds a row to <head>.csv in the same folder:
///
///     number,id,transmit_us,lines,beams,crc32,pose_ns
///
/// The file of a ping with directions has shape (2 rows, columns) and dtype <f4: ranges, then intensities.
/// `id` is the ping ID (number modulo 256), `crc32` is samples_crc32() in hexadecimal. Used only by the
/// render thread. A file that cannot be written is logged once and has no other effect.
class PingDump {
 public:
  /// Creates the folder and truncates the CSV file.
  /// @throws std::runtime_error naming the path
  PingDump(std::filesystem::path folder, std::string head);

  void write(const PosedPing& ping, const render::PingSamples& samples);

 private:
  std::filesystem::path folder_;
  std::string head_;
  std::ofstream index_;
  bool failed_ = false;
};

}  // namespace sonard::server
