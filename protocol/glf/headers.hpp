// SPDX-License-Identifier: Apache-2.0
// Headers of records, from which their size follows without unpacking.
// Source: protocol/glf/README.md 1.3, 1.4. No state; any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "protocol/common/byte_reader.hpp"
#include "protocol/glf/records.hpp"

namespace sonard::glf {

inline constexpr std::uint8_t record_id = 0x2A;  ///< '*', the first byte of every record
inline constexpr std::size_t ci_header_size = 21;
inline constexpr std::size_t image_header_size = 30;
inline constexpr std::size_t image_trailer_size = 34;
inline constexpr std::size_t status_body_size = 218;
inline constexpr std::uint16_t image_tag = 0xEFEF;
inline constexpr std::uint16_t image_end_tag = 0xDEDE;
inline constexpr std::uint16_t image_version = 3;  ///< the version with a field for the packing
/// The end of a closed .dat, after its last record.
inline constexpr std::array<std::uint8_t, 2> dat_terminator{0xDE, 0xDE};

/// The common header of all records.
struct CiHeader {
  std::uint8_t id = record_id;
  std::uint8_t version = 2;
  std::uint32_t length = 0;  ///< of the record with this header; wrong in images of some programs
  double time_s = 0.0;
  std::uint8_t type = 0;  ///< RecordType or an unknown type
  std::uint16_t device_id = 0;
  std::uint16_t node_id = 0;

  Origin origin() const { return {.time_s = time_s, .device_id = device_id, .node_id = node_id}; }
};

/// How the pixels of an image are stored. H.264 (2) also exists.
enum class Packing : std::uint16_t { zlib = 0, raw = 1 };

/// The header of an image, after the CiHeader.
struct ImageHeader {
  std::uint16_t record_type = 1;
  std::uint16_t tag = image_tag;
  std::uint16_t version = image_version;
  std::uint32_t first_line = 0;
  std::uint32_t end_line = 0;
  std::uint16_t range_compression = 0;
  std::uint32_t first_beam = 0;
  std::uint32_t end_beam = 0;
  Packing packing = Packing::zlib;  ///< absent in other versions; there data of the image's size is raw
  std::uint32_t data_size = 0;

  std::uint64_t lines() const { return end_line - first_line; }
  std::uint64_t beams() const { return end_beam - first_beam; }
  std::uint64_t pixels() const { return lines() * beams(); }
  /// Bytes from the end of the header to the end of the record.
  std::uint64_t rest() const { return data_size + beams() * sizeof(double) + image_trailer_size; }
};

/// Reads a header. Latches an error if the id is wrong; accepts any type.
CiHeader read_ci_header(ByteReader& reader);
/// Reads an image header. Latches an error if tag, lines or beams are invalid.
ImageHeader read_image_header(ByteReader& reader);

}  // namespace sonard::glf
