// SPDX-License-Identifier: Apache-2.0
// The ZIP records of a .glf, as tables for its writer and its reader. Source: protocol/glf/README.md 1.2.
// Only the parts that a .glf needs: no ZIP64, no encryption, one archive per file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>

#include "protocol/common/layout.hpp"

namespace sonard::glf::zip {

inline constexpr std::uint32_t local_signature = 0x04034B50;
inline constexpr std::uint32_t central_signature = 0x02014B50;
inline constexpr std::uint32_t end_signature = 0x06054B50;
inline constexpr std::uint16_t method_stored = 0;
inline constexpr std::uint16_t method_deflate = 8;
inline constexpr std::size_t block_header_size = 5;  ///< of a stored block of deflate

/// The common fields of an entry in the local header and in the central directory.
struct Entry {
  std::uint16_t version_needed = 20;
  std::uint16_t flags = 0;
  std::uint16_t method = method_deflate;
  std::uint16_t dos_time = 0;
  std::uint16_t dos_date = 0;
  std::uint32_t crc = 0;
  std::uint32_t compressed_size = 0;
  std::uint32_t size = 0;
  std::uint16_t name_size = 0;
  std::uint16_t extra_size = 0;
};

struct LocalHeader {
  std::uint32_t signature = local_signature;
  Entry entry;
};

struct CentralHeader {
  std::uint32_t signature = central_signature;
  std::uint16_t version_made_by = 20;
  Entry entry;
  std::uint16_t comment_size = 0;
  std::uint16_t disk = 0;
  std::uint16_t internal_attributes = 0;
  std::uint32_t external_attributes = 0;
  std::uint32_t local_offset = 0;
};

struct EndRecord {
  std::uint32_t signature = end_signature;
  std::uint16_t disk = 0;
  std::uint16_t directory_disk = 0;
  std::uint16_t entries_here = 0;
  std::uint16_t entries = 0;
  std::uint32_t directory_size = 0;
  std::uint32_t directory_offset = 0;
  std::uint16_t comment_size = 0;
};

template <class Part>
struct Layout;

template <>
struct Layout<Entry> : WholeLayout<26> {
  static constexpr auto fields = std::tuple{
      Field{0, "version_needed", &Entry::version_needed},
      Field{2, "flags", &Entry::flags},
      Field{4, "method", &Entry::method},
      Field{6, "dos_time", &Entry::dos_time},
      Field{8, "dos_date", &Entry::dos_date},
      Field{10, "crc", &Entry::crc},
      Field{14, "compressed_size", &Entry::compressed_size},
      Field{18, "size", &Entry::size},
      Field{22, "name_size", &Entry::name_size},
      Field{24, "extra_size", &Entry::extra_size},
  };
};

inline void read_value(ByteReader& reader, std::string_view, Entry& entry) {
  read_fields<Layout<Entry>>(reader, entry);
}
inline void write_value(ByteWriter& writer, const Entry& entry) {
  write_fields<Layout<Entry>>(writer, entry);
}

template <>
struct Layout<LocalHeader> : WholeLayout<30> {
  static constexpr auto fields = std::tuple{
      Field{0, "local_signature", &LocalHeader::signature},
      Field{4, "entry", &LocalHeader::entry},
  };
};

template <>
struct Layout<CentralHeader> : WholeLayout<46> {
  static constexpr auto fields = std::tuple{
      Field{0, "central_signature", &CentralHeader::signature},
      Field{4, "version_made_by", &CentralHeader::version_made_by},
      Field{6, "entry", &CentralHeader::entry},
      Field{32, "comment_size", &CentralHeader::comment_size},
      Field{34, "disk", &CentralHeader::disk},
      Field{36, "internal_attributes", &CentralHeader::internal_attributes},
      Field{38, "external_attributes", &CentralHeader::external_attributes},
      Field{42, "local_offset", &CentralHeader::local_offset},
  };
};

template <>
struct Layout<EndRecord> : WholeLayout<22> {
  static constexpr auto fields = std::tuple{
      Field{0, "end_signature", &EndRecord::signature},
      Field{4, "disk", &EndRecord::disk},
      Field{6, "directory_disk", &EndRecord::directory_disk},
      Field{8, "entries_here", &EndRecord::entries_here},
      Field{10, "entries", &EndRecord::entries},
      Field{12, "directory_size", &EndRecord::directory_size},
      Field{16, "directory_offset", &EndRecord::directory_offset},
      Field{20, "comment_size", &EndRecord::comment_size},
  };
};

}  // namespace sonard::glf::zip

template <>
struct sonard::WireSize<sonard::glf::zip::Entry> : std::integral_constant<std::size_t, 26> {};
