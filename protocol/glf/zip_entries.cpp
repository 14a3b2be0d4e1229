// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/zip_entries.hpp"

#include <algorithm>
#include <utility>

#include "protocol/common/byte_reader.hpp"
#include "protocol/glf/deflate.hpp"
#include "protocol/glf/zip.hpp"

namespace sonard::glf {
namespace {

constexpr std::size_t max_comment_size = 0xFFFF;
constexpr std::uint16_t encrypted_flag = 0x0001;

/// The last place where an end record fits and its comment ends with the archive.
std::optional<zip::EndRecord> find_end_record(std::span<const std::uint8_t> archive) {
  constexpr std::size_t size = zip::Layout<zip::EndRecord>::size;
  if (archive.size() < size) {
    return std::nullopt;
  }
  const std::size_t last = archive.size() - size;
  for (std::size_t back = 0; back <= std::min(last, max_comment_size); ++back) {
    ByteReader reader{archive.subspan(last - back)};
    zip::EndRecord end;
    read_fields<zip::Layout<zip::EndRecord>>(reader, end);
    if (end.signature == zip::end_signature && end.comment_size == back) {
      return end;
    }
  }
  return std::nullopt;
}

/// Goes from the directory to where the content of the entry lies.
Result<ZipEntry, WireError> located(std::span<const std::uint8_t> archive, const zip::CentralHeader& central,
                                    std::string_view name) {
  ByteReader reader{archive};
  reader.skip(central.local_offset, "local_header");
  zip::LocalHeader local;
  read_fields<zip::Layout<zip::LocalHeader>>(reader, local);
  if (local.signature != zip::local_signature) {
    reader.fail_at(central.local_offset, WireErrorReason::bad_value, "local_signature");
  }
  reader.skip(std::size_t{local.entry.name_size} + local.entry.extra_size, "entry_name");
  const std::size_t offset = reader.offset();
  const zip::Entry& entry = central.entry;  // local sizes may be missing, these may not
  const auto data = reader.bytes(entry.compressed_size, "entry_data");
  const bool deflated = entry.method == zip::method_deflate;
  if ((entry.flags & encrypted_flag) != 0 || !(deflated || entry.method == zip::method_stored)) {
    reader.fail_at(central.local_offset, WireErrorReason::bad_value, "method");
  }
  if (!deflated && entry.compressed_size != entry.size) {
    reader.fail_at(central.local_offset, WireErrorReason::bad_length, "size");
  }
  if (!reader.ok()) {
    return *reader.error();
  }
  return ZipEntry{.name = name,
                  .deflated = deflated,
                  .crc = entry.crc,
                  .size = entry.size,
                  .offset = offset,
                  .data = data};
}

/// Stored blocks from `start` on, the last one as far as it goes.
PiecewiseBytes stored_front(std::span<const std::uint8_t> archive, std::size_t start) {
  PiecewiseBytes pieces;
  ByteReader reader{archive.subspan(start)};
  for (bool last = false; !last;) {
    const std::uint8_t kind = reader.u8("block");
    const std::uint16_t size = reader.u16le("block");
    const std::uint16_t inverse = reader.u16le("block");
    if (!reader.ok() || (kind & 0x06) != 0 || (size ^ inverse) != 0xFFFF) {
      break;
    }
    pieces.append(reader.bytes(std::min<std::size_t>(size, reader.remaining()), "block"));
    last = (kind & 0x01) != 0;
  }
  return pieces;
}

}  // namespace

Result<std::vector<ZipEntry>, WireError> zip_entries(std::span<const std::uint8_t> archive) {
  const auto end = find_end_record(archive);
  if (!end) {
    return WireError{WireErrorReason::truncated, archive.size(), "end_signature"};
  }
  ByteReader reader{archive};
  reader.skip(end->directory_offset, "directory");
  std::vector<ZipEntry> entries;
  for (int i = 0; i < end->entries; ++i) {
    const std::size_t start = reader.offset();
    zip::CentralHeader central;
    read_fields<zip::Layout<zip::CentralHeader>>(reader, central);
    const auto name = reader.bytes(central.entry.name_size, "entry_name");
    reader.skip(std::size_t{central.entry.extra_size} + central.comment_size, "entry_name");
    if (central.signature != zip::central_signature) {
      reader.fail_at(start, WireErrorReason::bad_value, "central_signature");
    }
    if (!reader.ok()) {
      return *reader.error();
    }
    auto entry = located(archive, central, {reinterpret_cast<const char*>(name.data()), name.size()});
    if (!entry) {
      return entry.error();
    }
    entries.push_back(*entry);
  }
  return entries;
}

std::optional<PiecewiseBytes> stored_pieces(const ZipEntry& entry) {
  if (!entry.deflated) {
    return PiecewiseBytes{entry.data};
  }
  PiecewiseBytes pieces;
  ByteReader reader{entry.data};
  for (bool last = false; !last;) {
    const std::uint8_t kind = reader.u8("block");
    const std::uint16_t size = reader.u16le("block");
    const std::uint16_t inverse = reader.u16le("block");
    pieces.append(reader.bytes(size, "block"));
    if (!reader.ok() || (kind & 0x06) != 0 || (size ^ inverse) != 0xFFFF) {
      return std::nullopt;
    }
    last = (kind & 0x01) != 0;
  }
  return pieces.size() == entry.size ? std::optional{std::move(pieces)} : std::nullopt;
}

std::optional<PiecewiseBytes> cut_dat(std::span<const std::uint8_t> archive) {
  ByteReader reader{archive};
  while (reader.ok()) {
    zip::LocalHeader local;
    read_fields<zip::Layout<zip::LocalHeader>>(reader, local);
    const auto name = reader.bytes(local.entry.name_size, "entry_name");
    reader.skip(local.entry.extra_size, "entry_name");
    if (!reader.ok() || local.signature != zip::local_signature) {
      break;
    }
    if (std::string_view(reinterpret_cast<const char*>(name.data()), name.size()).ends_with(".dat")) {
      return local.entry.method == zip::method_deflate ? std::optional(stored_front(archive, reader.offset()))
                                                       : std::nullopt;
    }
    reader.skip(local.entry.compressed_size, "entry_data");
  }
  return std::nullopt;
}

Result<std::vector<std::uint8_t>, WireError> unpacked(const ZipEntry& entry, std::uint64_t max_size) {
  if (entry.size > max_size) {
    return WireError{WireErrorReason::bad_length, entry.offset, "size"};
  }
  std::optional<Bytes> content;
  if (entry.deflated) {
    content = inflate_exactly(entry.data, entry.size, DeflateForm::bare);
  } else {
    content.emplace(entry.data.begin(), entry.data.end());
  }
  if (!content) {
    return WireError{WireErrorReason::bad_value, entry.offset, "entry_data"};
  }
  Crc32 crc;
  crc.add(*content);
  if (crc.value() != entry.crc) {
    return WireError{WireErrorReason::bad_value, entry.offset, "crc"};
  }
  return std::move(*content);
}

}  // namespace sonard::glf
