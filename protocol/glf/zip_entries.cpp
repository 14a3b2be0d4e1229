// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/zip_entries.hpp"

#include <algorithm>
#include <utility>

#include "protocol/common/byte_reader.hpp"
#include "protocol/glf/deflate.hpp"
#include "protocol/glf/headers.hpp"
#include "protocol/glf/packer.hpp"
#include "protocol/glf/zip.hpp"

namespace sonard::glf {
namespace {

constexpr std::size_t max_comment_size = 0xFFFF;
constexpr std::uint16_t encrypted_flag = 0x0001;

/// The last end record with a comment that ends at the end of the archive.
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

/// Finds the content of an entry of the directory.
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
  const zip::Entry& entry = central.entry;  // sizes may be missing in the local header, but not here
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

struct BlockHeader {
  std::uint8_t kind = 0;
  std::uint16_t size = 0;
  std::uint16_t inverse = 0;

  bool is_stored() const { return (kind & 0x06) == 0 && (size ^ inverse) == 0xFFFF; }
};

/// The block header at `offset`; nullopt if the bytes end before the header does.
std::optional<BlockHeader> block_header_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  if (offset + zip::block_header_size > bytes.size()) {
    return std::nullopt;
  }
  ByteReader reader{bytes.subspan(offset)};
  BlockHeader header;
  header.kind = reader.u8("block");
  header.size = reader.u16le("block");
  header.inverse = reader.u16le("block");
  return header;
}

/// The size of the block with a damaged header at `offset`: a size after which another block follows.
std::optional<std::size_t> size_of_damaged_block(std::span<const std::uint8_t> bytes, std::size_t offset,
                                                 const BlockHeader& header, std::size_t size_before) {
  for (const std::size_t size :
       {std::size_t{header.size}, std::size_t{header.inverse} ^ 0xFFFFU, size_before, pack_block_size}) {
    const auto next = block_header_at(bytes, offset + zip::block_header_size + size);
    if (next && next->is_stored()) {
      return size;
    }
  }
  return std::nullopt;
}

/// True if a block header at `offset` is the first of a chain: another header or the end follows its block.
bool blocks_go_on_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  const auto header = block_header_at(bytes, offset);
  if (!header || header->kind > 1 || !header->is_stored()) {
    return false;
  }
  if (header->kind == 1) {
    return header->size == 0;
  }
  const std::size_t end = offset + zip::block_header_size + header->size;
  const auto next = block_header_at(bytes, end);
  return header->size > 0 && next && next->kind <= 1 && next->is_stored();
}

/// The first block header from `start` on, after bytes that are missing or too many.
std::optional<std::size_t> find_block(std::span<const std::uint8_t> bytes, std::size_t start) {
  for (std::size_t offset = start; offset + zip::block_header_size <= bytes.size(); ++offset) {
    if (bytes[offset] <= 1 && blocks_go_on_at(bytes, offset)) {
      return offset;
    }
  }
  return std::nullopt;
}

/// Stored blocks at the front of `bytes`; the last one may be cut. If no header follows a block, bytes are
/// missing or too many in it: the block then reaches to the next header.
DamagedDat stored_front(std::span<const std::uint8_t> bytes) {
  DamagedDat dat;
  std::size_t start = 0;  // of the content of the block before `offset`
  std::size_t offset = 0;
  const auto append_block = [&](std::size_t end) {
    dat.pieces.append(bytes.subspan(start, std::min(end, bytes.size()) - start));
  };
  while (const auto header = block_header_at(bytes, offset)) {
    const auto size = header->is_stored() ? std::optional(std::size_t{header->size})
                                          : size_of_damaged_block(bytes, offset, *header, offset - start);
    if (!size) {
      const auto found = find_block(bytes, start);
      if (!found) {
        dat.unread_size = bytes.size() - offset;
        break;
      }
      offset = *found;
      continue;
    }
    append_block(offset);
    start = offset + zip::block_header_size;
    // The flag for the last block may be damaged. It counts only in an empty block, which ends our archives.
    if (*size == 0 && (header->kind & 0x01) != 0) {
      return dat;
    }
    offset = start + *size;
  }
  append_block(offset);
  return dat;
}

bool is_dat(std::string_view name) {
  return name.ends_with(".dat");
}

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool begins_with_a_record(const DamagedDat& dat) {
  std::uint8_t first = 0;
  if (dat.pieces.size() > 0) {
    dat.pieces.copy(0, std::span{&first, 1});
  } else if (!dat.unpacked.empty()) {
    first = dat.unpacked.front();
  }
  return first == record_id;
}

struct Content {
  std::span<const std::uint8_t> data;  ///< to the end of the archive if the end of the entry is unknown
  bool deflated = false;
};

/// The content after a local header with the name of a .dat.
std::optional<Content> content_by_local_header(std::span<const std::uint8_t> archive) {
  constexpr std::size_t size = zip::Layout<zip::LocalHeader>::size;
  for (std::size_t at = 0; at + size <= archive.size(); ++at) {
    if (archive[at] != (zip::local_signature & 0xFF)) {
      continue;
    }
    ByteReader reader{archive.subspan(at)};
    zip::LocalHeader local;
    read_fields<zip::Layout<zip::LocalHeader>>(reader, local);
    if (local.signature != zip::local_signature) {
      continue;
    }
    const auto name = reader.bytes(local.entry.name_size, "entry_name");
    reader.skip(local.entry.extra_size, "entry_name");
    if (reader.ok() && is_dat(text_of(name))) {
      return Content{archive.subspan(at + reader.offset()), local.entry.method == zip::method_deflate};
    }
  }
  return std::nullopt;
}

/// The content of a .dat at its offset in the directory, without checking its local header.
std::optional<Content> content_by_directory(std::span<const std::uint8_t> archive) {
  const auto end = find_end_record(archive);
  ByteReader reader{archive};
  reader.skip(end ? end->directory_offset : archive.size(), "directory");
  while (reader.ok() && reader.remaining() > 0) {
    zip::CentralHeader central;
    read_fields<zip::Layout<zip::CentralHeader>>(reader, central);
    const auto name = reader.bytes(central.entry.name_size, "entry_name");
    reader.skip(std::size_t{central.entry.extra_size} + central.comment_size, "entry_name");
    const std::size_t start = std::size_t{central.local_offset} + zip::Layout<zip::LocalHeader>::size +
                              central.entry.name_size + central.entry.extra_size;
    if (reader.ok() && is_dat(text_of(name)) && start <= archive.size()) {
      const auto rest = archive.subspan(start);
      return Content{rest.first(std::min<std::size_t>(rest.size(), central.entry.compressed_size)),
                     central.entry.method == zip::method_deflate};
    }
  }
  return std::nullopt;
}

/// The content from the first block on that is not text, as the .cfg is. Needs neither names nor directory.
std::optional<Content> content_by_blocks(std::span<const std::uint8_t> archive) {
  for (auto at = find_block(archive, 0); at; at = find_block(archive, *at + 1)) {
    const auto block = archive.subspan(*at);
    if (block.front() == 0 && block[zip::block_header_size] != '<') {
      return Content{block, true};
    }
  }
  return std::nullopt;
}

DamagedDat dat_in(const Content& content, std::uint64_t max_size) {
  DamagedDat dat;
  if (content.deflated) {
    dat = stored_front(content.data);
  } else {
    dat.pieces = PiecewiseBytes{content.data};
  }
  if (dat.pieces.size() == 0) {
    dat.unread_size = 0;
    dat.unpacked = inflate_front(content.data, max_size);
  }
  return dat;
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
    if (central.signature != zip::central_signature) {
      reader.fail_at(start, WireErrorReason::bad_value, "central_signature");
    }
    const auto name = reader.bytes(central.entry.name_size, "entry_name");
    reader.skip(std::size_t{central.entry.extra_size} + central.comment_size, "entry_name");
    if (!reader.ok()) {
      return *reader.error();
    }
    auto entry = located(archive, central, text_of(name));
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
  bool last = false;
  for (std::size_t offset = 0; !last;) {
    const auto header = block_header_at(entry.data, offset);
    if (!header || !header->is_stored() ||
        header->size > entry.data.size() - offset - zip::block_header_size) {
      return std::nullopt;
    }
    pieces.append(entry.data.subspan(offset + zip::block_header_size, header->size));
    offset += zip::block_header_size + header->size;
    last = (header->kind & 0x01) != 0;
  }
  return pieces.size() == entry.size ? std::optional{std::move(pieces)} : std::nullopt;
}

std::optional<DamagedDat> damaged_dat(std::span<const std::uint8_t> archive, std::uint64_t max_size) {
  // A wrong place in the archive may begin like a record, but leaves less to read.
  const auto rank = [](const DamagedDat& dat) {
    return std::pair(begins_with_a_record(dat), dat.pieces.size() + dat.unpacked.size());
  };
  std::optional<DamagedDat> best;
  std::optional<Content> tried;
  for (const auto& find : {content_by_local_header, content_by_directory, content_by_blocks}) {
    if (find == content_by_blocks && best && begins_with_a_record(*best)) {
      break;
    }
    const auto content = find(archive);
    const bool again = content && tried && content->data.data() == tried->data.data() &&
                       content->deflated == tried->deflated;
    if (!content || again) {  // header and directory mostly agree; unpacking takes long
      continue;
    }
    tried = content;
    DamagedDat dat = dat_in(*content, max_size);
    if (!best || rank(dat) > rank(*best)) {
      best = std::move(dat);
    }
  }
  return best;
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
